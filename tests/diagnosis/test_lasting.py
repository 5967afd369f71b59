"""The second detector: what an effect explains over some seconds."""

from __future__ import annotations

import numpy as np
import pytest

from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.joint_gram import ridge_inverse
from cdia_pin.diagnosis.lasting import LEAST_SHARE, LastingDetector, limit_of
from cdia_pin.robot import load_robot

ROBOT = load_robot("scara")
BANK = Bank.of(ROBOT, ["coulomb_friction", "joint_spring"])
DT, MEMORY = 0.01, 4.0


def shown(
    remainder: np.ndarray, columns: np.ndarray, moves: bool = True, torque: float = 0.0
) -> LastingDetector:
    detector = LastingDetector(BANK, ROBOT.n, MEMORY)
    for y, r in zip(columns, remainder, strict=True):
        detector.add(DT, y, r, np.full(ROBOT.n, torque), np.full(ROBOT.n, moves))
    return detector


def series(seconds: float = 30.0) -> tuple[np.ndarray, np.ndarray]:
    """Columns of all joints along a slow swing, and noise of size 1."""
    t = np.arange(0.0, seconds, DT)
    q = np.sin(0.9 * t)
    y = np.stack([-np.sign(np.cos(0.9 * t)), -q, np.ones_like(t)], axis=1)
    rng = np.random.default_rng(7)
    return np.repeat(y[:, None, :], ROBOT.n, axis=1), rng.normal(size=(len(t), ROBOT.n))


def test_friction_far_below_the_noise_is_explained_in_its_size() -> None:
    y, noise = series()
    noise[:, 1] += 0.4 * y[:, 1, 0]
    explained = shown(noise, y).explained()
    assert explained[1, 0] == pytest.approx(0.4, rel=0.3)
    assert explained[0].max() < 0.2


def test_it_alarms_beyond_its_limit_alone() -> None:
    y, noise = series()
    noise[:, 1] += 0.4 * y[:, 1, 0]
    detector = shown(noise, y)
    assert not detector.beyond(np.zeros(ROBOT.n)).any()  # nothing has been learned
    detector.limit[:] = 0.25
    assert detector.beyond(np.zeros(ROBOT.n)).tolist() == [j == 1 for j in range(ROBOT.n)]


def test_a_model_may_be_off_by_a_share_of_the_torque_that_the_motion_takes() -> None:
    y, noise = series()
    noise[:, 1] += 0.4 * y[:, 1, 0]
    for torque, alarms in ((1.0, True), (10.0, False)):
        detector = shown(noise, y, torque=torque)
        detector.limit[:] = 0.25
        assert detector.beyond(np.zeros(ROBOT.n)).any() == alarms


def test_a_joint_at_rest_says_nothing() -> None:
    y, noise = series()
    assert not shown(noise + 5.0, y, moves=False).explained().any()


def test_the_limit_rises_with_the_time_between_false_alarms_that_is_asked_for() -> None:
    largest, torque = np.full((2, 2), 1.0), np.array([1.0, 100.0])
    often, rarely = (limit_of(largest, np.full(2, 60.0), MEMORY, every, torque) for every in (60.0, 36000.0))
    assert often[0, 0] == pytest.approx(1.0)
    assert rarely[0, 0] == pytest.approx(np.sqrt(np.log(9000.0) / np.log(15.0)))
    assert rarely[1] == pytest.approx(LEAST_SHARE * torque[1])


def test_columns_that_repeat_or_never_came_do_not_fail() -> None:
    y = np.column_stack([np.arange(5.0), 2 * np.arange(5.0), np.zeros(5)])
    b = y.T @ y[:, 0]
    theta = ridge_inverse(y.T @ y) @ b
    np.testing.assert_allclose(y @ theta, y[:, 0], atol=1e-4)
