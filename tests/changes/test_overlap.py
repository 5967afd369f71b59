"""Where two motions have nothing in common, it is said that nothing can be told, and why."""

import io
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from cdia_pin import Dynamics, load_robot, what_changed
from cdia_pin.effects import parse_term
from cdia_pin.logs import Log
from cdia_pin.viewers.change_words import changes_sentence
from cdia_pin.viewers.text_changes import changes_table

FAST, SLOW = (1.0, 0.9), (0.3, 0.2)  # amplitude [rad] and frequency [Hz]
REST = (0.0, 0.2)


def swing(robot, name, *motions):
    """A log in which each joint swings, or rests at amplitude zero."""
    t = np.arange(0.0, 20.0, 0.005)
    q, v, a = np.zeros((3, len(t), robot.n))
    for j, (amplitude, frequency) in enumerate(motions):
        w = 2 * np.pi * frequency
        q[:, j], v[:, j] = amplitude * np.sin(w * t), amplitude * w * np.cos(w * t)
        a[:, j] = -(w**2) * q[:, j]
    effort = Dynamics(robot, (parse_term("viscous_friction@joint1: coefficient=0.1"),)).inverse_dynamics(
        q, v, a
    )
    noise = np.random.default_rng(1).normal(0.0, 0.01, effort.shape)
    return Log(robot.joints, t, q, effort + noise, source=name)


def plain(shown):
    console = Console(file=io.StringIO(), width=200, color_system=None)
    console.print(shown)
    return console.file.getvalue()


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


def test_joints_that_move_alike_in_no_log_are_not_compared_and_the_reason_is_said(robot):
    found = what_changed(
        Dynamics(robot), swing(robot, "fast.csv", FAST, FAST), swing(robot, "slow.csv", SLOW, REST)
    )
    assert found.verdict == "not-comparable"
    assert found.to_dict()["not_compared"] == {"joint1": "moves at other speeds", "joint2": "rests after"}
    assert not found.changes
    assert not found.bounds
    assert "cannot be told" in changes_sentence(found)
    said = plain(changes_table(found))
    assert "joint2, at rest in slow.csv" in said
    assert "joint1, hardly ever at the same speeds in both" in said


def test_a_joint_whose_effort_was_not_recorded_is_not_compared(robot):
    """Before, its drive seemed to have a gain of several hundred."""
    one, other = (swing(robot, name, FAST, FAST) for name in ("one.csv", "other.csv"))
    effort = other.effort * [1.0, 0.0]
    found = what_changed(Dynamics(robot), one, replace(other, effort=effort))
    assert found.to_dict()["not_compared"] == {"joint2": "no effort was recorded"}
    assert not found.changes
    assert "joint2, without an effort in one of them" in " ".join(plain(changes_table(found)).split())


def test_a_joint_that_moves_alike_is_compared_though_another_one_rests(robot):
    found = what_changed(
        Dynamics(robot), swing(robot, "one.csv", FAST, FAST), swing(robot, "other.csv", FAST, REST)
    )
    assert found.verdict == "unchanged"
    assert set(found.not_compared) == {"joint2"}
    assert set(found.bounds) <= {"joint1"}
    for errors in found.to_dict()["rms"].values():
        assert set(errors) == {"joint1"}


@pytest.mark.parametrize(("spread", "said"), [(1.2, False), (2.04, True)])
def test_where_the_model_fails_differently_the_answer_says_so(robot, spread, said):
    logs = (swing(robot, name, FAST, FAST) for name in ("one.csv", "other.csv"))
    found = replace(what_changed(Dynamics(robot), *logs), spread=spread)
    assert found.to_dict()["spread"] == spread
    text = " ".join(plain(changes_table(found)).split())
    assert ("effects that are not there seem 2.0 times as certain as by chance" in text) is said


@pytest.mark.parametrize(("motions", "same"), [((FAST, FAST), True), ((FAST, SLOW), False)])
def test_the_answer_knows_whether_the_motion_is_the_same(robot, motions, same):
    logs = (swing(robot, name, FAST, m) for name, m in zip(("one.csv", "other.csv"), motions, strict=True))
    found = what_changed(Dynamics(robot), *logs)
    assert found.same_motion == same
    said = " ".join(plain(changes_table(replace(found, spread=2.0))).split())
    assert ("The motion is the same" in said) == same
