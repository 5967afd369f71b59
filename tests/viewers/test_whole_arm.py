"""What acts on a whole arm, in pictures and tables: a contact, a payload, a tilt."""

from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from cdia_pin import Dynamics, Monitor, load_robot
from cdia_pin.diagnosis import Event, Verdict
from cdia_pin.diagnosis.record import BelievedFaults, replay
from cdia_pin.dynamics import exciting_trajectory, simulate
from cdia_pin.effects import BaseTilt, CoulombFriction, ExternalWrench, Payload, Term
from cdia_pin.viewers import joints_table
from cdia_pin.viewers.live import FrameMaker
from cdia_pin.viewers.report_monitor import monitor_data
from cdia_pin.viewers.scene import timeline_of_run
from cdia_pin.viewers.scene.attached import NOTHING, AttachedWords, attached_rows
from cdia_pin.viewers.scene.run_timeline import event_label
from cdia_pin.viewers.whole_arm_row import whole_arm_row

PUSH = Term(ExternalWrench("elbow_joint"), (3.0, 0.0, -4.0, 0.0, 0.0, 0.0))
PAYLOAD = Term(Payload(), (2.0, 0.0, 0.02, 0.1, *[0.0] * 6))
TILT = Term(BaseTilt(), (0.3424, 0.0))  # 2° of 9.81 m/s²
FRICTION = Term(CoulombFriction("elbow_joint"), (4.0,))


@pytest.fixture(scope="module")
def robot():
    return load_robot("ur5")


@pytest.fixture(scope="module")
def run(robot):
    """A healthy run, to which beliefs are added by hand."""
    log = simulate(Dynamics(robot), exciting_trajectory(robot, np.random.default_rng(0), duration=2.0))
    return replay(Monitor(Dynamics(robot), threshold=dict.fromkeys(robot.joints, 5.0), rate=log.rate), log)


@pytest.mark.parametrize("name", ["ur5", "panda", "scara"])
def test_an_arrow_stands_where_the_force_acts(name):
    robot = load_robot(name)
    rng, document_of = np.random.default_rng(1), AttachedWords(robot)
    q, step = rng.uniform(-1.0, 1.0, robot.n), 1e-6
    for j, joint in enumerate(robot.joints):
        at = document_of([Term(ExternalWrench(joint), (1.0, *[0.0] * 5))])["push"]["at"]

        def place(q, j=j, at=at):
            return (robot.joint_placements(q)[j] @ [*at, 1.0])[:3]

        moves = np.array([(place(q + d) - place(q - d)) / (2 * step) for d in step * np.eye(robot.n)]).T
        np.testing.assert_allclose(moves, robot.link_end_jacobians(q)[j, :3], atol=2e-4)  # points have 0.1 mm


def test_a_payload_is_at_its_centre_of_mass(robot):
    body = AttachedWords(robot)([PAYLOAD])["body"]
    assert body["mass"] == 2.0
    assert body["joint"] == "wrist_3_joint"
    np.testing.assert_allclose(body["at"], (robot.tool_placement @ [0.0, 0.01, 0.05, 1.0])[:3], atol=1e-4)


def test_words_say_what_it_is_and_how_large(robot):
    words = AttachedWords(robot)([FRICTION, PUSH, PAYLOAD, TILT])["words"]
    assert words == ["force 5.00 N on the link of elbow", "payload 2.00 kg", "base tilt 2.00°"]


def test_it_is_gone_when_it_is_gone(robot):
    rows = attached_rows([(1.0, [FRICTION]), (2.0, [PUSH]), (2.5, [PUSH, FRICTION]), (3.0, [])], robot)
    assert [time for time, _ in rows] == [2.0, 3.0]
    assert rows[-1][1] == NOTHING


def test_a_timeline_and_live_frames_have_it(run, robot):
    beliefs = (BelievedFaults(0.5, (PAYLOAD,)), BelievedFaults(1.0, (PAYLOAD, PUSH)), BelievedFaults(1.5, ()))
    shown = timeline_of_run(replace(run, beliefs=beliefs)).to_dict()["attached"]
    assert [t for t, _ in shown] == [0.5, 1.0, 1.5]
    assert [bool(now["push"]) for _, now in shown] == [False, True, False]
    monitor = Monitor(Dynamics(robot), threshold=dict.fromkeys(robot.joints, 5.0), rate=100.0)
    frame_of, q = FrameMaker(robot), np.zeros(robot.n)
    frames = []
    for k, faults in enumerate([(), (PUSH,), (PUSH,), ()]):
        status = monitor.update(0.1 * k, q, q, q)
        status.faults = faults
        frames.append(frame_of(0.1 * k, q, status))
    assert ["attached" in frame for frame in frames] == [False, True, False, True]
    assert frames[-1]["attached"] == [(0.3, NOTHING)]


def test_tables_have_a_row_for_the_whole_arm(run):
    assert whole_arm_row(run) == ("healthy", ())
    found = replace(run, faults=(PUSH, PAYLOAD, FRICTION))
    stage, believed = whole_arm_row(found)
    assert stage == "isolated"  # nothing is compensated during contact
    assert ["external wrench" in believed[0], "payload" in believed[1]] == [True, True]
    assert whole_arm_row(replace(run, faults=(PAYLOAD,))).stage == "accommodated"
    console = Console(width=160, record=True, file=open("/dev/null", "w"))  # noqa: SIM115, PTH123
    console.print(joints_table(found))
    lines = console.export_text().splitlines()
    (elbow,) = (line for line in lines if line.strip().startswith("elbow"))
    assert "coulomb friction" in elbow
    assert "wrench" not in elbow
    assert any("whole arm" in line and "external wrench" in line for line in lines)


def test_the_report_has_it_too(run):
    data = monitor_data(replace(run, faults=(PUSH, FRICTION)))
    assert data["arm"]["name"] == "whole arm"
    assert data["arm"]["stage"] == "isolated"
    assert ["wrench" in text for joint in data["joints"] for text in joint["believed"]] == [False]


def test_an_engine_that_knows_joints_alone_has_no_such_row(run):
    assert whole_arm_row(replace(run, record={**run.record, "engine": "thesis"})) is None


def test_a_label_says_that_a_contact_is_there_and_that_it_is_gone(robot):
    joints = robot.joints[:2]
    there = Event(1.0, "isolation", joints, Verdict.UNIQUE, (PUSH,), reason="5 N on the link of elbow_joint")
    gone = Event(2.0, "idle", joints, Verdict.NONE, (PUSH,), reason="the contact is gone")
    assert event_label(there, robot) == "contact on the link of elbow"
    assert event_label(gone, robot).endswith("the contact is gone")
