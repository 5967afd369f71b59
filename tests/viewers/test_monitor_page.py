"""The page of a monitor's run: everything that was said, small, and silent on the network."""

import io
import json
import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from cdia_pin import load_robot
from cdia_pin.diagnosis import Event, MonitorRun, Stage, Verdict
from cdia_pin.diagnosis.journal import BelievedFaults, Look
from cdia_pin.diagnosis.record import STAGES
from cdia_pin.diagnosis.status import LASTS
from cdia_pin.effects import Between, CoulombFriction, LoadFriction, Term, Unknown
from cdia_pin.viewers import events_table, joints_table, run_summary, tracking_table, write_monitor_report
from cdia_pin.viewers.event_words import event_rows
from cdia_pin.viewers.page import LARGEST
from cdia_pin.viewers.report_monitor import monitor_data
from cdia_pin.viewers.stage_colours import STAGE_COLOURS, STAGE_WORDS
from tests.narrow_terminals import loses_nothing

DATA = re.compile(r'<script type="application/json" id="data">(.*?)</script>', re.DOTALL)
FRICTION = Term(CoulombFriction("joint1"), (4.0,), ci95=((3.8, 4.2),))
LOAD = Term(LoadFriction("joint1"), (0.1,))
LOOKS = (
    Look(13.5, "joint1", ("coulomb_friction",), (("load_friction",),)),
    Look(15.0, "joint1", ("coulomb_friction",)),
    Look(18.0, "joint1", ()),
)
BELIEFS = (
    BelievedFaults(14.0, (FRICTION,)),
    BelievedFaults(16.0, (replace(FRICTION, theta=(3.9,)),)),
    BelievedFaults(18.0, ()),
)


def a_run(count=500):
    """A SCARA whose first joint is detected, isolated and then idle."""
    robot = load_robot("scara")
    rng = np.random.default_rng(0)
    time = np.linspace(10.0, 20.0, count)
    stages = np.zeros((count, 4), np.uint8)
    for begin, stage in ((13.0, Stage.DETECTED), (14.0, Stage.ACCOMMODATED), (18.0, Stage.IDLE)):
        stages[time >= begin, 0] = STAGES.index(stage)
    signal = rng.standard_normal((count, 4))
    events = (
        Event(13.0, "detection", ("joint1",), Verdict.NONE),
        Event(
            14.0,
            "isolation",
            ("joint1",),
            Verdict.AMBIGUOUS,
            (FRICTION,),
            ((LOAD,),),
            "load it <differently>",
        ),
        Event(14.0, "accommodation", ("joint1",), Verdict.AMBIGUOUS, (FRICTION,), ((LOAD,),)),
        Event(18.0, "idle", ("joint1",), Verdict.NONE, (FRICTION,), reason="gone"),
        Event(19.0, "accommodation", robot.joints, Verdict.NONE, reason="not a number; nominal control"),
    )
    record = {
        "version": "0",
        "engine": "momentum",
        "bank": ["coulomb_friction", "load_friction"],
        "settings": {"accommodate": True},
        "healthy": [],
        "notes": ["a note"],
        "sight": {
            joint: {"threshold": 1.0, "torque_rms": 1.0 / share, "share": share, "blind": share > 0.3}
            for joint, share in zip(robot.joints, (0.12, 0.1, 0.1, 0.45), strict=True)
        },
    }
    return MonitorRun(
        robot, time, signal, np.ones((count, 4)), stages, 0.1 * signal, signal, signal, signal, signal + 0.01,
        events, (FRICTION,), record, LOOKS, BELIEFS,
    )  # fmt: skip


@pytest.fixture(scope="module")
def run():
    return a_run()


@pytest.fixture(scope="module")
def page(run, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "new" / "watch.html"
    tracking = {"healthy": np.full(4, 1e-3), "faulty": np.full(4, np.inf), "accommodated": np.full(4, 2e-3)}
    write_monitor_report(path, run, tracking=tracking, since=13.0, command="cdia monitor <a>")
    return path.read_text(encoding="utf-8")


def test_what_is_in_the_page_is_what_was_collected(page):
    (text,) = DATA.findall(page)
    found = json.loads(text)
    assert found["command"] == "cdia monitor <a>"
    assert [j["name"] for j in found["joints"]] == ["joint1", "joint2", "joint3", "joint4"]
    assert [i[2] for i in found["joints"][0]["stages"]] == ["healthy", "detected", "accommodated", "idle"]
    assert found["joints"][0]["stages"][1][:2] == pytest.approx([13.0, 14.0], abs=0.03)
    assert found["tracking"]["runs"]["faulty"] == [None] * 4
    assert found["joints"][3]["units"]["residual"] == "N"
    assert [j["blind"] for j in found["joints"]] == [False, False, False, True]
    assert found["joints"][3]["share"] == "45\u00a0%"
    assert found["joints"][0]["believed"] == ["coulomb friction: level 4.00 ± 0.20\u00a0N·m"]


def test_nothing_is_requested_and_no_name_is_markup(page):
    assert "<differently>" not in page
    assert set(re.findall(r"""\b(?:src|href|action|data|poster|srcset)\s*=\s*["']([^"']*)""", page)) == {
        "data:,"
    }
    assert "default-src 'none'" in page


def test_intervals_of_a_joint_cover_the_run(run):
    for joint in monitor_data(run)["joints"]:
        ends = [i[1] for i in joint["stages"]]
        assert joint["stages"][0][0] == 10.0
        assert ends[-1] == 20.0
        assert [i[0] for i in joint["stages"][1:]] == ends[:-1]


def test_hypotheses_live_from_the_detection_until_they_are_excluded(run):
    first, *others = monitor_data(run)["joints"]
    rows = {row["effect"]: row["spans"] for row in first["hypotheses"]}
    assert list(rows) == ["coulomb friction", "load friction", "none of these"]
    begin = first["stages"][1][0]
    assert rows["coulomb friction"] == [(begin, 13.5, "open"), (13.5, 18.0, "leading")]
    assert rows["load friction"] == [(begin, 13.5, "open"), (13.5, 15.0, "possible")]
    assert rows["none of these"] == []
    assert all(j["hypotheses"] == [] for j in others)


def test_parameters_are_shown_as_they_were_believed(run):
    joints = monitor_data(run, present=[replace(FRICTION, theta=(4.1,))])["joints"]
    (level,) = joints[0]["parameters"]
    assert (level["effect"], level["name"], level["unit"]) == ("coulomb friction", "level", "N·m")
    assert level["time"] == [10.0, 14.0, 16.0, 18.0, 20.0]
    assert level["value"] == [None, 4.0, 3.9, None, None]
    assert level["low"] == [None, 3.8, 3.8, None, None]
    assert level["real"] == 4.1
    assert joints[1]["parameters"] == []


def test_faults_of_the_plant_are_marked_where_they_are(run):
    fault = replace(FRICTION, profile=Between(12.5, 17.5))
    first, second, *_ = monitor_data(run, present=[fault])["joints"]
    ((begin, end, name),) = first["present"]
    assert (begin, end) == pytest.approx((12.5, 17.5), abs=0.03)
    assert name == "coulomb friction"
    assert second["present"] == []


def test_the_fitted_effect_is_drawn_over_the_signal_that_it_follows():
    run = a_run(2000)
    speed = np.tile(np.sin(np.linspace(0, 60, 2000))[:, None], 4)
    shown = monitor_data(replace(run, velocity=speed))["joints"][0]["against"]
    assert shown["fitted"] == ["coulomb friction"]
    x, torque = (np.array(v) for v in shown["signals"]["velocity"]["curve"])
    np.testing.assert_allclose(torque[np.abs(x) > 0.1], -3.9 * np.sign(x[np.abs(x) > 0.1]), rtol=0.02)
    assert shown["signals"]["load"]["curve"] is None


def test_an_hour_still_fits(tmp_path):
    path = write_monitor_report(tmp_path / "long.html", a_run(360_000))
    assert path.stat().st_size <= LARGEST


def test_the_velocity_error_of_the_thesis_has_its_own_unit(run):
    other = replace(run, record={**run.record, "engine": "thesis", "sight": {}})
    assert monitor_data(other)["joints"][3]["share"] == "–"
    assert monitor_data(other)["joints"][0]["units"]["residual"] == "rad/s"


def test_isolation_and_the_accommodation_at_once_are_one_line(run):
    rows = event_rows(run.events, run.robot)
    assert [r.stage for r in rows] == ["detection", "isolation, accommodation", "idle", "accommodation"]
    assert rows[1].alternatives == ("load friction",)
    assert rows[1].verdict == "one of several"
    assert rows[3].joints == "all"


def test_an_unknown_fault_is_not_described_by_its_weights(run):
    unknown = Term(Unknown(joint="joint2"), tuple(np.zeros(Unknown(joint="joint2").size)))
    event = Event(1.0, "isolation", ("joint2",), Verdict.UNKNOWN, (unknown,))
    (row,) = event_rows([event], run.robot)
    assert row.said == ("unknown fault; its torque was learned",)


def test_no_table_of_a_run_loses_a_character_in_a_narrow_terminal(run):
    loses_nothing(events_table(run))
    loses_nothing(joints_table(run))
    loses_nothing(tracking_table(run.robot, {"healthy": np.ones(4), "accommodated": 2e9 * np.ones(4)}, 3.0))


def test_the_terminal_says_the_same(run):
    console = Console(width=100, record=True, quiet=False, file=open("/dev/null", "w"))  # noqa: SIM115, PTH123
    console.print(events_table(run))
    console.print(joints_table(run))
    console.print(tracking_table(run.robot, {"healthy": np.ones(4), "accommodated": 2 * np.ones(4)}, 3.0))
    text = " ".join(console.export_text().split())
    assert "one of several: coulomb friction: level 4.00 ± 0.20 N·m" in text
    assert "or load friction" in text
    assert "<differently>" in text
    assert "2.00 ×" in text
    assert "1000 mrad" in text
    assert "45 %" in text
    assert "healthy, blind" in text


def test_the_summary_is_a_sentence(run):
    said = run_summary(run)
    assert said.startswith("In 10 s the residual left its threshold on joint1, first at 13.000 s.")
    assert "coulomb friction on joint1" in said
    quiet = replace(run, events=(), faults=(), residual=np.full(run.residual.shape, [0.1, 0.2, 0.6, 0.4]))
    assert run_summary(quiet) == (
        "No fault was detected in 10 s. The residual came nearest to its threshold on joint3: 60\u00a0% of it. "
        "Blind: joint4."
    )


def test_a_fault_that_was_known_before_is_nothing_new(run):
    said = run_summary(replace(run, events=(), residual=np.full(run.residual.shape, [2.0, 0.2, 0.6, 0.4])))
    assert said.startswith("Nothing new was detected in 10 s. At the end: coulomb friction on joint1")
    assert "above its threshold" not in said


def test_a_clock_that_starts_again_does_not_count_backwards(run):
    again = replace(run, time=np.concatenate([[99.0], run.time[1:] - run.time[1]]))
    assert again.duration == pytest.approx(run.duration, abs=0.2)
    assert "-" not in run_summary(again).partition("first")[0]
    assert "no sample is later" in run_summary(replace(run, time=np.full(len(run.time), 5.0)))


def test_a_residual_above_its_threshold_without_a_detection_is_explained(run):
    quiet = replace(run, events=(), faults=(), residual=np.full(run.residual.shape, [0.1, 1.9, 0.6, 0.4]))
    said = run_summary(quiet)
    assert said.startswith(
        "No fault was detected in 10 s. On joint2 the residual was above its threshold without"
    )
    assert "nearest" not in said


def test_a_fault_that_is_not_isolated_remains_and_one_on_a_blind_joint_is_doubted(run):
    stages = run.stages.copy()
    stages[-1] = [STAGES.index(s) for s in (Stage.HEALTHY, Stage.HEALTHY, Stage.HEALTHY, Stage.DETECTED)]
    event = Event(13.0, "detection", ("joint4",), Verdict.NONE, reason=LASTS)
    quiet = np.full(run.residual.shape, [0.1, 0.2, 0.6, 2.0])
    said = run_summary(replace(run, stages=stages, events=(event,), faults=(), residual=quiet))
    assert said == (
        "In 10 s a small residual lasted on joint4, first at 13.000 s. "
        "Doubt the detection on joint4: the monitor is blind there. The fault on joint4 "
        "is not isolated yet. Blind: joint4."
    )


def test_a_residual_is_compared_with_its_threshold_of_that_moment(run):
    threshold, residual = np.ones(run.threshold.shape), np.zeros(run.residual.shape)
    threshold[:50, 0], residual[:50, 0] = 4.0, 3.0
    changing = replace(run, threshold=threshold, residual=residual)
    assert changing.typical_threshold[0] == 1.0
    assert changing.nearness[0] == pytest.approx(0.75)
    console = Console(width=120, record=True, file=io.StringIO())
    console.print(joints_table(changing))
    assert "75 %" in " ".join(console.export_text().split())
    assert monitor_data(changing)["joints"][0]["nearness"] == pytest.approx(0.75)


def test_every_stage_has_a_colour_of_its_own():
    assert set(STAGE_COLOURS) == set(STAGE_WORDS) == set(Stage)
    assert len(set(STAGE_COLOURS.values())) == len(Stage)


@pytest.mark.skipif(shutil.which("chromium") is None, reason="no chromium to open the page in")
def test_a_browser_draws_it(page, tmp_path):
    (tmp_path / "watch.html").write_text(page, encoding="utf-8")
    command = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=3000",
               "--dump-dom", f"file://{tmp_path}/watch.html"]  # fmt: skip
    out = subprocess.run(command, capture_output=True, text=True, timeout=180, check=False).stdout
    assert out.count('class="strip"') == 4
    assert out.count('class="uplot') >= 3
    assert "diverged" in out
