"""What a check advises is said in the words of the page: it has no command line."""

import asyncio

import numpy as np
import pytest

from cdia_pin import Dynamics, Log, exciting_trajectory, load_robot, write_log
from cdia_pin.app.advice import ROBOT, advice_words
from cdia_pin.app.inputs import Request
from cdia_pin.app.workbench import Workbench
from cdia_pin.logs.checks.effort_kind import KINDS


@pytest.mark.parametrize(
    ("advice", "words"),
    [
        ("--convert angle=deg", "read angles in deg"),
        ("--convert flip_effort=a,b", "flip the torque of a, b"),
        ("check the unit of time (--convert time=ms)", "check the unit of time"),
        (
            "ignore the recorded velocities: --convert use_velocity=false",
            "ignore the recorded velocities",
        ),
        (
            "if they are currents, --convert torque=A --gains gains.json",
            "if they are currents, read torques as motor currents, with drive gains",
        ),
        ("--convert torque=mA", "read torques as motor currents in mA, with drive gains"),
        (
            "--robot ur10 if it is that arm; otherwise check the unit",
            "choose the robot ur10 if it is that arm; otherwise check the unit",
        ),
        ("record 10 s or more", "record 10 s or more"),
    ],
)
def test_an_advice_has_no_options(advice, words):
    assert advice_words(advice) == words


def test_no_kind_of_effort_leaves_an_option():
    said = [advice_words(kind.advice.format(inverse="elbow_joint:101")) for kind in KINDS]
    assert not [words for words in said if "--" in words]


def test_a_log_of_another_arm_is_read_as_its_own(tmp_path):
    robot, rng = load_robot("ur10"), np.random.default_rng(2)
    time = np.arange(0.0, 20.0, 0.008)
    q, v, a = exciting_trajectory(robot, rng, duration=20.0)(time)
    tau = Dynamics(robot).inverse_dynamics(q, v, a)
    tau += 0.01 * tau.std(axis=0) * rng.standard_normal(tau.shape)
    log = write_log(Log(robot.joints, time, q, tau), tmp_path / "run.csv")
    bench = Workbench(tmp_path / "drops")
    asyncio.run(bench.load(Request("ur3", log)))
    advice = " ".join(f.advice for f in bench.session.inputs.check.problems)
    (named,) = ROBOT.findall(advice)
    asyncio.run(bench.take_robot(named))
    assert bench.session.inputs.robot.name == named == "ur10"
    assert bench.session.inputs.check.about("robot") == ()
