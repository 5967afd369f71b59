"""Timelines: a run or a comparison as the player shows it."""

import json

import numpy as np
import pytest

from cdia_pin import Dynamics, Log, compare, load_robot, view
from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings
from cdia_pin.diagnosis import MonitorSettings
from cdia_pin.diagnosis.record import STAGES
from cdia_pin.effects import parse_term
from cdia_pin.errors import CdiaError
from cdia_pin.viewers.live import FrameMaker
from cdia_pin.viewers.scene import monitor_stages, timeline_of_comparison, timeline_of_log, timeline_of_run

FAULT = "viscous_friction@joint2: coefficient=0.2, after=4"


@pytest.fixture(scope="module")
def loop():
    return ClosedLoop(
        Dynamics(load_robot("double_pendulum")), LoopSettings(rate=250.0, healthy_duration=10.0, seed=4)
    )


@pytest.fixture(scope="module")
def watcher(loop):
    return loop.monitor(
        bank=["coulomb_friction", "viscous_friction"], settings=MonitorSettings(accommodate=True)
    )


@pytest.fixture(scope="module")
def run(loop, watcher):
    return loop.run(loop.motion(0, 8.0), [parse_term(FAULT)], watcher).monitored


def test_frames_come_at_thirty_a_second(run):
    timeline = timeline_of_run(run)
    assert np.diff(timeline.time).min() > 0
    assert len(timeline.time) == pytest.approx(8 * 30, abs=8)
    assert timeline.time[-1] == run.time[-1]


def test_a_long_run_has_fewer_frames():
    time = np.linspace(0, 600, 60_001)
    log = Log(("a",), time, np.zeros((len(time), 1)), np.zeros((len(time), 1)))
    assert len(timeline_of_log(log).time) <= 2402


def test_the_stages_are_those_of_the_run(run):
    timeline = timeline_of_run(run)
    (track,) = timeline.tracks
    stage = [STAGES[k] for k in track.stage[:, 1]]
    at = int(np.searchsorted(timeline.time, 3.9))
    assert set(stage[:at]) <= {"healthy", "suspect"}
    assert stage[-1] == "accommodated"
    assert "detected" in stage
    assert [s.name for s in timeline.stages] == [str(s) for s in STAGES]
    detected = int(np.argmax(np.array(stage) == "detected"))
    assert track.level[detected, 1] > 1
    assert abs(track.torque[detected, 1]) > 0
    assert (track.torque[:at, 1][np.array(stage[:at]) == "healthy"] == 0).all()


def test_the_label_names_the_fault(run):
    (track,) = timeline_of_run(run).tracks
    said = [text for _, text in track.label]
    assert "not isolated yet" in said[0]
    assert "viscous friction on joint2: coefficient" in said[-1]
    assert len(said) == len(set(said))


def test_the_json_is_small_and_the_same_each_time(run):
    text = json.dumps(timeline_of_run(run).to_dict(), allow_nan=False)
    assert text == json.dumps(timeline_of_run(run).to_dict(), allow_nan=False)
    assert len(text) < 60_000


def test_live_frames_are_those_of_the_record(loop, watcher, run):
    from itertools import islice

    frame_of = FrameMaker(loop.model.robot)
    ticks = islice(loop.ticks(loop.motion(0, 8.0), [parse_term(FAULT)], watcher), 8 * 250)
    frames = [f for t in ticks if (f := frame_of(t.time, t.q, t.status, t.desired))]
    live = np.array([f["stage"][0] for f in frames])
    (track,) = timeline_of_run(run).tracks
    time = np.array([f["time"][0] for f in frames])
    assert np.median(np.diff(time)) == pytest.approx(1 / 30, abs=0.004)
    changed = lambda t, s: t[np.flatnonzero(np.diff(s[:, 1])) + 1]  # noqa: E731
    recorded = timeline_of_run(run).time
    np.testing.assert_allclose(changed(time, live)[-2:], changed(recorded, track.stage)[-2:], atol=0.05)
    assert [text for f in frames for _, text in f.get("label", [])][-1] == track.label[-1][1]


def test_a_comparison_fades_as_the_model_gets_better(results):
    timeline = timeline_of_comparison(results.given, results.improved, results.discovery)
    given, improved = timeline.tracks
    assert given.level.max() > 0.8
    assert np.abs(improved.level).max() < 0.5 * given.level.max()
    assert given.name == "as given"
    assert "friction" in improved.name or "effects" in improved.name
    document = timeline.to_dict()
    assert document["variants"][0]["name"] == improved.name
    assert "RMS" in document["label"][0][1]


def test_a_good_model_is_not_painted_as_a_bad_one(results):
    (track,) = timeline_of_comparison(results.improved).tracks
    assert track.level.max() < 0.6


def test_healthy_stays_near_its_own_colour():
    shares = {s.name: s for s in monitor_stages()}
    assert shares["healthy"].most < 0.3 < shares["suspect"].least
    assert len({s.colour for s in shares.values()}) == len(shares)


class TestView:
    def test_a_page_without_network(self, tmp_path):
        page = view(load_robot("scara"), [0.1, 0.2, 0.3, 0.05])
        text = page.save(tmp_path / "deep" / "arm.html").read_text(encoding="utf-8")
        assert "default-src 'none'" in text
        assert "src=" not in text.split("<script>")[0]
        assert len(text) < 1_200_000

    def test_a_notebook_gets_a_frame_of_its_own(self):
        shown = view(Dynamics(load_robot("scara")))._repr_html_()
        assert shown.startswith("<iframe")
        assert 'sandbox="allow-scripts"' in shown
        assert shown.count('"') == shown.count('="') * 2  # nothing ends the attribute early

    def test_a_run_and_a_comparison_and_a_log(self, run, results):
        pendulum = run.robot
        assert '"stage"' in view(pendulum, run).html
        assert "model error" in view(results.robot, results.given).html
        assert '"time"' in view(results.robot, results.logs[0]).html

    def test_what_is_of_another_arm_is_refused(self, run):
        with pytest.raises(CdiaError, match="not of scara"):
            view(load_robot("scara"), run)

    def test_what_cannot_be_written_is_reported(self, tmp_path):
        (tmp_path / "file").write_text("")
        with pytest.raises(CdiaError, match="cannot be written"):
            view(load_robot("scara")).save(tmp_path / "file" / "arm.html")

    def test_the_robot_may_have_any_name(self, tmp_path):
        path = tmp_path / "x.urdf"
        text = load_robot("scara").urdf.read_text().replace('"joint2"', '"&lt;/script&gt;&lt;b&gt;"')
        path.write_text(text)
        assert "</script><b>" not in view(load_robot(path)).html

    def test_a_compared_log_needs_no_more_than_its_comparison(self, results):
        given = compare(Dynamics(results.robot), results.logs[0])
        assert "model error" in view(results.robot, given).html
