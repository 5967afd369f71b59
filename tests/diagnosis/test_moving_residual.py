"""Bounds of a healthy residual in motion, near rest, and at speeds that no healthy run has had."""

from __future__ import annotations

import numpy as np
import pytest

from cdia_pin.diagnosis import Bank, MonitorSettings
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.moving_residual import LEAST_LOWERED, learn_moving
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.residuals import Watched
from cdia_pin.dynamics import Dynamics
from cdia_pin.robot import load_robot

ROBOT = load_robot("scara")
DT = 0.01
LONG = 12_000  # samples: two minutes, from which no bound is widened


def watched(at_rest: float, in_motion: float) -> Watched:
    """White noise of one size near rest, and of another one in motion; half of the time each, on all joints."""
    rng = np.random.default_rng(3)
    moves = np.arange(2 * LONG) // 500 % 2 == 1
    size = np.where(moves, in_motion, at_rest)
    noise = rng.uniform(-1.0, 1.0, (2 * LONG, ROBOT.n))
    return Watched(size[:, None] * noise, np.repeat(moves[:, None], ROBOT.n, axis=1))


def test_the_bound_in_motion_is_that_of_motion() -> None:
    settings = MonitorSettings()
    rest_bound = np.full(ROBOT.n, 13.0)
    found = learn_moving([watched(10.0, 1.0)], [], DT, rest_bound, np.full(ROBOT.n, 1.0), settings)
    white = settings.noise_margin / np.sqrt(3.0)  # RMS of uniform noise of size 1 is 1 / √3
    assert found.bound == pytest.approx(np.full(ROBOT.n, white), rel=0.1)
    assert found.level == pytest.approx(np.full(ROBOT.n, 1 / np.sqrt(3.0)), rel=0.15)


def test_the_bound_in_motion_is_lowered_to_a_share_of_the_torque_at_most() -> None:
    rest_bound = np.full(ROBOT.n, 13.0)
    found = learn_moving([watched(10.0, 0.01)], [], DT, rest_bound, np.full(ROBOT.n, 20.0), MonitorSettings())
    assert found.bound == pytest.approx(np.full(ROBOT.n, LEAST_LOWERED * 20.0))


def test_the_bound_in_motion_is_never_above_that_near_rest() -> None:
    rest_bound = np.full(ROBOT.n, 0.5)
    found = learn_moving([watched(0.1, 0.1)], [], DT, rest_bound, np.full(ROBOT.n, 20.0), MonitorSettings())
    assert found.bound == pytest.approx(rest_bound)


def test_motion_that_the_model_was_not_fitted_to_counts() -> None:
    given = (DT, np.full(ROBOT.n, 50.0), np.full(ROBOT.n, 1.0), MonitorSettings())
    alone = learn_moving([watched(10.0, 1.0)], [], *given)
    tried = learn_moving([watched(10.0, 1.0)], [watched(10.0, 4.0)], *given)
    assert (tried.bound > 2.0 * alone.bound).all()


def threshold_at(speed: float) -> float:
    """Settled threshold of the first joint at a steady speed; bounds are 1 in motion and 3 near rest, up to 2 rad/s."""
    bank = Bank.of(ROBOT, ["coulomb_friction"])
    observer = MomentumObserver(Nominal.of(Dynamics(ROBOT)), bank.prototypes, MonitorSettings(), DT)
    observer.use_velocities(np.outer([-2.0, 2.0], np.ones(ROBOT.n)))
    observer.state.bound, observer.state.rest_bound = 1.0, 3.0
    v = np.full(ROBOT.n, speed)
    for k in range(200):
        observer.step(k * DT, np.zeros(ROBOT.n), v, np.zeros(ROBOT.n))
    return float(observer.threshold[0])


def test_the_threshold_follows_the_state() -> None:
    assert threshold_at(1.0) == pytest.approx(1.0, rel=1e-3)
    assert threshold_at(0.0) == pytest.approx(3.0, rel=1e-3)
    assert threshold_at(3.0) == pytest.approx(3.0 * 1.5, rel=1e-3)  # half as fast again as any healthy run
    assert threshold_at(-3.0) == pytest.approx(3.0 * 1.5, rel=1e-3)
