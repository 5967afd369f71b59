"""A session without a page: two hidden effects are found and added one by one, and undone."""

import json
import subprocess
import sys
import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import CdiaError, load_model, load_robot
from cdia_pin.app.exports import model_file, python_file, report_file, urdf_file
from cdia_pin.app.inputs import Request
from cdia_pin.app.job import Cancelled, Job
from cdia_pin.app.next_motion import designed, doubts
from cdia_pin.app.picture import joint, timeline
from cdia_pin.app.python_lines import python_lines
from cdia_pin.app.session import Session
from cdia_pin.app.suggestions import suggestions
from cdia_pin.resources import logs_dir

LOG = logs_dir() / "demo_ur5.csv"  # hidden: a payload, and Coulomb friction of the elbow
COULOMB = "coulomb_friction@elbow_joint"


@pytest.fixture(scope="module")
def loaded():
    return Session.load(Request("ur5", LOG))


@pytest.fixture(scope="module")
def searched(loaded):
    return loaded.search()


@pytest.fixture(scope="module")
def explained(searched):
    return searched.add("payload").add(COULOMB)


def test_a_search_ranks_what_is_missing(searched):
    assert "payload" in {r.term.label for r in searched.found.ranking[:3]}
    assert {s.term.label for s in searched.found.steps} == {"payload", COULOMB}


def test_the_error_falls_with_each_effect(explained):
    errors = [v.error for v in explained.history.path]
    assert errors[0] > 3 * errors[1] > 6 * errors[2]
    assert explained.present.model.find(COULOMB).theta[0] == pytest.approx(5.0, rel=0.01)


def test_a_step_leaves_the_session_before_it_as_it_was(loaded, explained):
    assert loaded.history.at == 0
    assert loaded.present.model.terms == ()
    assert explained.history.at == 2


def test_undo_and_redo(explained, searched):
    back = explained.undo().undo()
    assert back.present is searched.present
    assert back.found is searched.found
    assert not back.history.can_undo
    assert back.redo().redo().present is explained.present
    assert not back.redo().redo().history.can_redo
    other = explained.undo().add("torque_offset@elbow_joint")
    assert [v.added for v in other.history.path[1:]] == [("payload",), ("torque_offset@elbow_joint",)]


def test_a_preview_changes_nothing_and_is_what_is_added(loaded):
    tried = loaded.with_preview("payload")
    assert tried.history is loaded.history
    assert tried.preview.error < tried.present.error
    added = tried.add("payload")
    assert added.present is tried.preview  # nothing is computed again
    assert added.preview is None
    assert tried.without_preview().preview is None


def test_all_that_the_search_found_is_added_at_once(searched, explained):
    at_once = searched.add_found()
    assert set(at_once.present.added) == {"payload", COULOMB}
    assert at_once.present.error == pytest.approx(explained.present.error, rel=0.02)


def test_a_fault_in_what_is_asked_changes_nothing(loaded):
    with pytest.raises(CdiaError, match="coulomb_friction"):
        loaded.add("coulom_friction@elbow_joint")
    with pytest.raises(CdiaError, match="no search"):
        loaded.add_found()
    with pytest.raises(CdiaError, match="no log"):
        Session.load(Request("ur5", LOG.with_name("none.csv")))


def test_mapping_of_joints_and_units(tmp_path, loaded):
    lines = LOG.read_text().splitlines()
    names = lines[0].replace("elbow_joint", "third")
    values = [row.split(",") for row in lines[1:1500]]
    at = [k for k, name in enumerate(names.split(",")) if name.startswith("position")]
    for row in values:
        for k in at:
            row[k] = repr(float(np.degrees(float(row[k]))))
    other = tmp_path / "degrees.csv"
    other.write_text("\n".join([names, *(",".join(row) for row in values)]))
    asked = Request("ur5", other)
    with pytest.raises(CdiaError, match="third"):
        Session.load(asked)
    mapped = replace(asked, joint_map={"third": "elbow_joint"})
    wrong = Session.load(mapped)
    assert any("angle=deg" in f.advice for f in wrong.inputs.check.problems)
    right = Session.load(replace(mapped, convert={"angle": "deg"}))
    assert right.inputs.check.ok
    np.testing.assert_allclose(right.inputs.log.position, loaded.inputs.log.position[:1499], atol=1e-9)


def test_the_python_lines_end_with_the_same_model(explained, tmp_path):
    run(explained, tmp_path)
    again = load_model(tmp_path / "model.json", load_robot("ur5"))
    assert again.terms == explained.present.model.terms
    assert (tmp_path / "corrected.urdf").is_file()
    assert (tmp_path / "report.html").is_file()


def test_the_python_lines_of_a_search(searched, tmp_path):
    at_once = searched.add_found()
    run(at_once, tmp_path)
    again = load_model(tmp_path / "model.json", load_robot("ur5"))
    assert again.terms == at_once.present.model.terms


def test_the_python_lines_name_how_a_log_was_read(loaded):
    asked = replace(
        loaded.inputs.request, joint_map={"third": "elbow_joint"}, convert={"angle": "deg"}, name="run.csv"
    )
    script = python_lines(replace(loaded, inputs=replace(loaded.inputs, request=asked)))
    assert (
        "read_log('run.csv', robot, joint_map={'third': 'elbow_joint'}, convert={'angle': 'deg'})" in script
    )


def run(session, folder):
    (folder / "same.py").write_bytes(python_file(session))
    subprocess.run([sys.executable, "same.py"], cwd=folder, check=True, capture_output=True, timeout=120)


def test_exports(explained, searched):
    document = json.loads(model_file(explained))
    assert [t["effect"] for t in document["terms"]] == ["payload", "coulomb_friction"]
    urdf = urdf_file(explained).decode()
    assert "cdia_payload" in urdf
    assert 'friction="4.99' in urdf
    page = report_file(explained).decode()
    assert "with payload" in page or '"added":"payload"' in page
    assert len(page) > 100_000
    with pytest.raises(CdiaError, match="place in a URDF"):
        urdf_file(searched)


def test_the_whole_path_is_one_discovery(explained):
    path = explained.history.discovery
    assert [s.term.label for s in path.steps] == ["payload", COULOMB]
    assert path.model is explained.present.model
    assert path.trace[0].rms == pytest.approx(explained.history.first.comparison.rms)
    assert explained.undo().undo().history.discovery is None


# ------------------------------------------------------------------ jobs


def test_who_cancels_work_does_not_wait_for_it():
    goes_on, heard = threading.Event(), []

    def work(tell):
        tell("working", 0.5)
        goes_on.wait()
        try:
            tell("still working", 0.6)
        except Cancelled:
            heard.append("cancelled")
            raise

    job = Job(work)
    while job.share == 0.0:
        time.sleep(0.01)
    job.cancel()
    with pytest.raises(Cancelled):
        job.result()
    assert not heard
    goes_on.set()
    while not heard:  # at its next word
        time.sleep(0.01)


def test_a_search_that_is_cancelled_changes_nothing(loaded):
    job = Job(loaded.search)
    job.cancel()
    with pytest.raises(Cancelled):
        job.result()
    assert loaded.found is None


def test_two_sessions_at_once_do_not_disturb_each_other(loaded, searched):
    other = Session.load(Request("ur5", LOG))
    jobs = [Job(lambda tell, s=s: s.add("payload", tell)) for s in (loaded, other)]
    first, second = (job.result(60.0) for job in jobs)
    assert first.present.model.terms == second.present.model.terms
    assert searched.add("payload").present.model.terms == first.present.model.terms


def test_an_error_is_that_of_the_work():
    def fails(tell):
        tell("trying", 0.5)
        raise CdiaError("it cannot be")

    job = Job(fails)
    with pytest.raises(CdiaError, match="cannot be"):
        job.result(5.0)
    assert (job.said, job.share, job.cancelled) == ("trying", 0.5, False)


def test_the_share_that_is_done_never_falls():
    job = Job(lambda tell: [tell("a", 0.6), tell("b", 0.2)])
    job.result(5.0)
    assert (job.said, job.share) == ("b", 0.6)


# ------------------------------------------------------------------ what a page shows


def test_suggestions_begin_with_what_the_search_would_add(searched):
    rows = suggestions(searched.found)
    assert [r.text for r in rows if r.chosen] == [r.text for r in rows[:2]] == ["payload", COULOMB]
    assert rows[0].before > 5 * rows[0].after
    assert rows[0].where == "the whole arm"
    assert rows[0].numbers[0].startswith("mass 1.500")
    assert len({r.text for r in rows}) == len(rows)
    assert all(r.after < r.before for r in rows)


def test_confusions_become_motions_to_record(searched):
    tried = searched.add("asymmetric_friction@elbow_joint").search()
    said = doubts(tried)
    assert any("friction" in d.pair and ("slowly" in d.motion or "speeds" in d.motion) for d in said), [
        (d.pair, d.motion) for d in said
    ]


def test_a_doubt_becomes_a_motion(searched):
    (doubt, *_) = [d for d in doubts(searched.add("torque_offset@elbow_joint").search()) if d.tellable]
    content, gain = designed(searched, doubt, lambda sentence, share: None)
    heads, *rows = content.decode().splitlines()
    assert heads.startswith("time,position.shoulder_pan_joint") and len(rows) > 1000
    assert "standard deviations" in gain


def test_what_is_drawn_is_thinned_and_of_both_models(explained, loaded):
    drawn = timeline(explained)
    assert len(drawn["time"]) <= 1500
    assert [drawn["name"], drawn["variants"][0]["name"]] == [
        "as given",
        "improved",
    ]
    assert "variants" not in timeline(loaded)
    signals = joint(explained, "elbow_joint")
    assert signals["before"]["rms"] > 5 * signals["after"]["rms"]
    assert len(signals["time"]["time"]) <= 1600
    assert joint(loaded, "elbow_joint")["after"] is None


def test_a_preview_is_drawn_beside_the_model_as_given(loaded):
    tried = loaded.with_preview("payload")
    assert joint(tried, "wrist_1_joint")["after"]["rms"] < joint(tried, "wrist_1_joint")["before"]["rms"]
    assert timeline(tried)["variants"][0]["name"] == "preview"
