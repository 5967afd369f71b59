"""A joint at rest tells its load only if its motor carries it: a brake or static friction says nothing."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, compare, discover, load_robot
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.rest import RestSettings
from cdia_pin.viewers.short_answer import short_answer
from cdia_pin.viewers.text_changes import errors_by_log
from cdia_pin.viewers.verdict import mean_share, rest_words, verdict_sentences
from tests.made_logs import motion


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


def resting(robot, carried, friction=0.1):
    """The first joint swings, the second rests, and its motor carries a share of the load."""
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    q[:, 1], v[:, 1], a[:, 1] = 0.4, 0.0, 0.0
    effort = Dynamics(robot).inverse_dynamics(q, v, a)
    effort[:, 1] *= carried
    effort[:, 0] += friction * np.sign(v[:, 0])
    return Log(robot.joints, t, q, effort + np.random.default_rng(0).normal(0.0, 0.002, effort.shape))


@pytest.mark.parametrize(("carried", "held"), [(1.0, False), (0.5, False), (0.0, True)])
def test_a_joint_is_held_if_its_torque_does_not_follow_its_load(robot, carried, held):
    experiment = Experiment.of(robot, [condition(resting(robot, carried), robot)])
    assert experiment.resting.tolist() == [False, True]
    assert experiment.held.tolist() == [False, held]
    assert experiment.informative[:, 1].any() != held


def shaking(robot, travel):
    """The first joint swings, the second shakes in its place, where friction pulls either way by turns."""
    log = resting(robot, 1.0)
    t, q, effort = log.time, log.position.copy(), log.effort.copy()
    q[:, 1] += travel / 2 * np.sin(2 * np.pi * 0.7 * t)
    effort[:, 1] += 0.3 * np.sin(2 * np.pi * 0.11 * t)
    return Log(robot.joints, t, q, effort)


@pytest.mark.parametrize(("travel", "held"), [(0.01, True), (0.1, False)])
def test_a_joint_that_shakes_in_its_place_is_held(robot, travel, held):
    experiment = Experiment.of(robot, [condition(shaking(robot, travel), robot)])
    assert experiment.resting.tolist() == [False, held]
    assert experiment.held.tolist() == [False, held]
    assert experiment.informative[:, 1].any() != held


def test_nothing_is_named_on_a_joint_that_shakes_in_its_place(robot):
    found = discover(Dynamics(robot), shaking(robot, 0.01))
    assert found.held == ("joint2",)
    assert [s.term.label for s in found.steps] == ["coulomb_friction@joint1"]


def test_a_joint_that_is_held_has_no_error_in_tables(robot):
    table = errors_by_log([compare(Dynamics(robot), shaking(robot, 0.01))])
    assert [str(next(iter(column.cells))) for column in table.columns][2] == "–"


def test_a_joint_travels_from_half_a_percent_of_its_range_a_turn_or_a_metre_on():
    scara = load_robot("scara")  # joint 3 may turn by more than a turn, joint 4 slides by 0.2 m
    least = 0.005 * np.array([2 * 2.61799388, 2 * 2.44346095, 2 * np.pi, 0.2])
    for j in range(scara.n):
        for share, travels in ((0.9, False), (1.1, True)):
            end = np.ones(scara.n)
            end[j] = share * least[j]
            moved = RestSettings().travels(np.vstack([np.zeros(scara.n), end]), scara)
            assert moved.tolist() == [travels or k != j for k in range(scara.n)]


def test_an_arm_that_moves_about_one_posture_is_not_held(robot):
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    about = Log(
        robot.joints,
        t,
        0.3 + 0.003 * q,
        Dynamics(robot).inverse_dynamics(0.3 + 0.003 * q, 0.003 * v, 0.003 * a),
    )
    experiment = Experiment.of(robot, [condition(about, robot)])
    assert not experiment.in_place.any()
    assert not experiment.held.any()


def test_a_joint_without_any_load_is_not_called_held(robot):
    t = np.arange(0.0, 20.0, 0.01)
    q = np.zeros((len(t), 2))
    experiment = Experiment.of(robot, [condition(Log(robot.joints, t, q, np.zeros_like(q)), robot)])
    assert not experiment.held.any()


def test_what_a_brake_carries_is_no_payload(robot):
    log = resting(robot, 0.0)
    found = discover(Dynamics(robot), log)
    assert [s.term.label for s in found.steps] == ["coulomb_friction@joint1"]
    assert "joint2 is at rest, and the torque does not tell the load" in " ".join(verdict_sentences(found))
    assert "0 to" not in dict(short_answer(found))["good for"]
    assert list(found.to_dict()["capability"]["friction"]) == ["joint1"]
    comparison = compare(Dynamics(robot), log)
    assert comparison.mean_error == pytest.approx(comparison.relative_rms[0])


def test_what_only_a_joint_at_rest_shows_is_descriptive_and_in_no_mean(robot):
    found = discover(Dynamics(robot), resting(robot, 0.5))
    confidence = {s.term.label: s.confidence for s in found.steps}
    assert confidence.pop("coulomb_friction@joint1") == "established"
    assert confidence and set(confidence.values()) == {"descriptive"}
    assert found.resting == ("joint2",) == tuple(found.to_dict()["resting"])
    first = found.trace[0]
    assert mean_share(first.rms, found) == pytest.approx(first.rms[0] / found.torque_rms[0])
    assert "joint2" not in found.structure_left
    assert "descriptive" in rest_words(found)
    none_moves = replace(found, held=("joint1",))  # one rests, a brake holds the other
    assert none_moves.counted.all()
    assert rest_words(none_moves) == "what they show is likely at most"
    assert list(found.to_dict()["capability"]["friction"]) == ["joint1"]
    assert "at rest, or too slow for its encoder, and static friction carries a part of its load" in " ".join(
        verdict_sentences(found)
    )
    assert dict(short_answer(found))["at rest"].startswith("joint2")


def test_a_joint_without_load_is_not_said_to_be_braked():
    arm, t = load_robot("ur5"), np.arange(0.0, 20.0, 0.01)
    q = np.tile([0.1, -1.0, 1.0, 0.3, 0.2, 0.1], (len(t), 1))  # the pan joint carries nothing
    effort = np.tile(arm.inverse_dynamics(q[0], np.zeros(6), np.zeros(6)), (len(t), 1))
    effort[:, 0] = 0.0
    found = discover(Dynamics(arm), Log(arm.joints, t, q, effort))
    assert found.torque_rms[0] == 0
    assert found.held == ()
    assert "at rest" not in " ".join(verdict_sentences(found))
