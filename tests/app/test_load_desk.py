"""A form that cannot be read stays open at what is wrong, and goes on from there."""

import asyncio
import json

import numpy as np
import pytest

from benchmarks.recordings import lerobot, numbered, write
from cdia_pin import Dynamics, load_robot, save_model
from cdia_pin.app.inputs import Request
from cdia_pin.app.load_desk import LoadDesk
from cdia_pin.app.python_lines import python_lines
from cdia_pin.app.runner import Runner
from cdia_pin.effects import parse_term
from cdia_pin.resources import logs_dir
from tests.made_logs import with_velocity

JOINTS = load_robot("ur5").joints


@pytest.fixture(scope="module")
def foreign(tmp_path_factory):
    """A log of currents whose joints have other names than the robot's, and its gains."""
    folder = tmp_path_factory.mktemp("foreign")
    head, *rows = (logs_dir() / "demo_ur5.csv").read_text().splitlines()[:1500]
    for joint in JOINTS:
        head = head.replace(joint, joint[::-1])
    log = folder / "run.csv"
    log.write_text("\n".join([head.replace("effort.", "current."), *rows]))
    (folder / "gains").mkdir()
    (folder / "gains" / "gains.json").write_text(json.dumps(dict.fromkeys(JOINTS, 1.0)))
    return log


def read(desk, asked):
    drawn = []
    return asyncio.run(desk.read(asked, drawn.append)), drawn


def test_a_log_that_does_not_fit_opens_the_table_and_loads_from_it(foreign):
    desk = LoadDesk(Runner())
    loaded, drawn = read(desk, Request("ur5", foreign))
    assert loaded is None and desk.is_open
    assert len(drawn) == 1  # the robot is read first
    assert "mapping" in desk.faults and "--" not in desk.faults["mapping"]
    assert desk.columns.currents
    assert {joint: row["label"] for joint, row in desk.form.joints.items()} == {j: j[::-1] for j in JOINTS}
    desk.take(foreign.parent / "gains")
    loaded, _ = read(desk, desk.form.request())
    assert not desk.is_open and desk.faults == {}
    assert loaded.session.inputs.log.joints == JOINTS


@pytest.mark.parametrize("chosen", [{}, {"effort": "J# mom"}])
def test_columns_of_any_names_are_proposed_and_load_as_proposed(tmp_path, chosen):
    log = with_velocity(load_robot("ur5"))
    columns = {"t": log.time, **numbered("J", np.degrees(log.position), "{}{} ang")}
    path = write(tmp_path / "plc.csv", columns | numbered("J", log.effort, "{}{} mom"))
    desk = LoadDesk(Runner())
    loaded, _ = read(desk, Request("ur5", path, columns=chosen))
    assert loaded is None and desk.is_open
    assert "no position columns" in desk.faults["mapping"] and "--" not in desk.faults["mapping"]
    assert desk.form.columns == {"position": "J# ang", "effort": "J# mom"}
    assert desk.form.units["angle"] == "deg"
    loaded, _ = read(desk, desk.form.request())
    assert not desk.is_open
    np.testing.assert_allclose(loaded.session.inputs.log.position, log.position)
    assert "columns={'position': 'J# ang'" in python_lines(loaded.session)
    desk.form.log, desk.form.units["angle"] = str(logs_dir() / "demo_ur5.csv"), ""
    loaded, _ = read(desk, desk.form.request())
    assert loaded.session.inputs.request.columns == {}  # they were of the log before


def test_an_episode_is_asked_for_and_read(tmp_path):
    log = with_velocity(load_robot("ur5"))
    names = [f"{joint}.{signal}" for signal in ("pos", "torque") for joint in JOINTS]
    values = np.hstack([log.position, log.effort])
    desk = LoadDesk(Runner())
    read(desk, Request("ur5", lerobot(tmp_path / "set", log, names, values, episodes=2)))
    assert "2 episodes" in desk.faults["log"] and "--" not in desk.faults["log"]
    desk.form.episode = "1"
    read(desk, desk.form.request())
    assert "does not state the unit of its positions" in desk.faults["mapping"]
    desk.form.units["angle"] = "rad"
    loaded, _ = read(desk, desk.form.request())
    np.testing.assert_allclose(loaded.session.inputs.log.effort, log.effort)


def test_gains_of_joints_that_the_robot_does_not_have_are_not_kept(tmp_path):
    desk = LoadDesk(Runner())
    desk.form.robot = "ur5"
    read(desk, desk.form.request())
    (tmp_path / "gains.json").write_text(json.dumps({JOINTS[0]: 2.0, "another": 3.0}))
    assert desk.take(tmp_path).joints == {JOINTS[0]: {"gain": "2.0"}}


def test_a_robot_alone_is_read_and_asks_for_its_log():
    desk = LoadDesk(runner := Runner())
    loaded, drawn = read(desk, desk.form.request())
    assert loaded is None and not drawn and "robot" in desk.faults
    desk.form.robot = "ur55"
    loaded, drawn = read(desk, desk.form.request())
    assert "did you mean" in desk.faults["robot"] and desk.form.robot == "ur55"
    desk.form.robot = "ur5"
    loaded, drawn = read(desk, desk.form.request())
    assert loaded is None and len(drawn) == 1 and desk.faults == {}
    assert "now give its log" in runner.said and desk.is_open


def test_a_saved_model_goes_with_its_robot(tmp_path):
    robot = load_robot("ur5")
    save_model(Dynamics(robot, (parse_term("payload: mass=0.1"),)), tmp_path / "model.json")
    desk = LoadDesk(Runner())
    desk.form.robot = "ur5"
    read(desk, desk.take(tmp_path).request())
    assert desk.form.model == tmp_path / "model.json" and len(desk.arm.terms) == 1
    desk.form.robot = "ur10"
    read(desk, desk.form.request())
    assert desk.form.model is None and desk.faults == {} and desk.arm.robot.name == "ur10"


def test_rows_of_another_robot_are_dropped():
    desk = LoadDesk(Runner())
    desk.form.robot, desk.form.log = "ur5", str(logs_dir() / "demo_ur5.csv")
    desk.form.note("panda_joint1", "label", "first")
    loaded, _ = read(desk, desk.form.request())
    assert loaded is not None and desk.form.joints == {}


def test_options_of_the_command_read_the_log_as_every_other_command_does(foreign):
    gains = foreign.parent / "gains" / "gains.json"
    named = [f"{j[::-1]}={j}" for j in JOINTS]
    asked = Request.as_typed(
        "ur5", foreign, gains=gains, joint_map=named, convert=["flip_effort=elbow_joint"]
    )
    assert asked.reading["gains"] == dict.fromkeys(JOINTS, 1.0)
    assert asked.convert == {"flip_effort": ("elbow_joint",)}
    loaded, drawn = read(LoadDesk(Runner()), asked)
    assert loaded and drawn
    assert Request.as_typed("ur5", foreign, columns=["position=q_#"]).columns == {"position": "q_#"}
