"""A model that was learned from the healthy runs is noticed, and tried on halves of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.refitted_halves import is_log_of, refitted_halves
from cdia_pin.diagnosis.residuals import least_piece
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import parse_term
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.robot import load_robot

ROBOT = load_robot("ur5")
LEAST = least_piece(MonitorSettings())


@pytest.fixture(scope="module")
def run() -> Log:
    """Half a minute in which the last joint rests, with noise of its encoder, and the elbow rubs."""
    t = np.arange(0.0, 30.0, 0.01)
    swing = [np.sin((0.5 + 0.13 * j) * t + j) for j in range(ROBOT.n - 1)]
    rng = np.random.default_rng(5)
    q = np.stack([*swing, np.zeros_like(t)], axis=1) + rng.normal(0.0, 1e-5, (len(t), ROBOT.n))
    v = np.gradient(q, t, axis=0)
    effort = np.array([ROBOT.inverse_dynamics(*x) for x in zip(q, v, np.zeros_like(q), strict=True)])
    effort[:, 2] += 5.0 * np.tanh(v[:, 2] / 0.02)
    return Log(ROBOT.joints, t, q, effort + rng.normal(0.0, 0.05, effort.shape))


def model_of(run: Log, level: float = 5.0) -> Dynamics:
    term = parse_term(f"coulomb_friction@elbow_joint: level={level}", ROBOT)
    return replace(Dynamics(ROBOT, (term,)), learned_from=(condition(run, ROBOT),))


def test_a_joint_that_rests_does_not_hide_that_a_log_is_known(run: Log) -> None:
    motion = condition(run, ROBOT)
    assert is_log_of(motion, run)
    assert not is_log_of(motion, replace(run, position=run.position[::-1]))


def test_each_half_gets_the_terms_of_the_other_one(run: Log) -> None:
    pairs = refitted_halves(model_of(run, level=2.0), [run], LEAST)
    assert len(pairs) == 2
    for half, (other,) in pairs:
        assert half.of_joints[0].theta[0] == pytest.approx(5.0, rel=0.05)
        assert other.duration == pytest.approx(15.0, abs=0.1)


def test_a_model_of_another_log_is_left_alone(run: Log) -> None:
    other = replace(run, position=run.position[::-1], effort=run.effort[::-1])
    assert refitted_halves(model_of(other), [run], LEAST) == ()
    assert refitted_halves(Dynamics(ROBOT), [run], LEAST) == ()
