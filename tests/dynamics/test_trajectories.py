"""Exciting motions: within limits, from rest to rest, and derivatives that belong together."""

import numpy as np
import pytest

from cdia_pin.dynamics import exciting_trajectory
from cdia_pin.dynamics.trajectories import FASTEST, FASTEST_SLIDE, LONGEST_SLIDE, WIDEST
from cdia_pin.errors import RobotError
from cdia_pin.robot import catalogue, load_robot


@pytest.fixture(
    scope="module",
    params=[name for name, entry in catalogue().items() if entry.source != "robot_descriptions"],
)
def arm(request):
    return load_robot(request.param)


def dense(trajectory):
    return trajectory(np.arange(0.0, trajectory.duration, 1e-3))


@pytest.mark.parametrize("seed", range(3))
def test_it_stays_within_the_limits(arm, seed):
    full = exciting_trajectory(arm, np.random.default_rng(seed), speed=1.0, reach=1.0)
    q, v, _ = dense(full)
    assert (q >= arm.limits.lower).all() and (q <= arm.limits.upper).all()
    assert (np.abs(v) <= arm.limits.velocity).all()
    assert (np.abs(v).max(0) <= np.where(arm.is_prismatic, FASTEST_SLIDE, FASTEST)).all()
    free = np.isinf(arm.limits.upper) & np.isinf(arm.limits.lower)
    assert (np.abs(q[:, free]) <= np.where(arm.is_prismatic, LONGEST_SLIDE, WIDEST)[free]).all()


def test_every_joint_moves(arm):
    q, v, _ = dense(exciting_trajectory(arm, np.random.default_rng(0)))
    assert np.isfinite(q).all()
    assert (np.ptp(q, axis=0) > 0.01).all()
    assert (v.min(0) < 0).all() and (v.max(0) > 0).all()


def test_it_rests_at_both_ends_and_beyond(arm):
    trajectory = exciting_trajectory(arm, np.random.default_rng(0), duration=7.0)
    q, v, a = trajectory([-1.0, 0.0, 7.0, 9.0])
    np.testing.assert_allclose(q, np.tile(trajectory.centre, (4, 1)), atol=1e-12)
    np.testing.assert_allclose(v, 0.0, atol=1e-12)
    np.testing.assert_allclose(a, 0.0, atol=1e-9)


def test_velocity_and_acceleration_are_its_derivatives():
    trajectory = exciting_trajectory(load_robot("scara"), np.random.default_rng(1))
    t, h = np.linspace(0.1, 19.9, 100), 1e-5
    before, now, later = (trajectory(t + k * h) for k in (-1, 0, 1))
    np.testing.assert_allclose((later.q - before.q) / (2 * h), now.v, atol=1e-7)
    np.testing.assert_allclose((later.v - before.v) / (2 * h), now.a, atol=1e-6)


def test_one_time_equals_a_batch_of_times():
    trajectory = exciting_trajectory(load_robot("ur5"), np.random.default_rng(1))
    one, many = trajectory(3.0), trajectory([3.0, 4.0])
    assert one.q.shape == (6,)
    for a, b in zip(one, many, strict=True):
        np.testing.assert_allclose(a, b[0], atol=1e-12)


def test_the_same_seed_is_the_same_motion():
    arm = load_robot("ur5")
    one, same, other = (exciting_trajectory(arm, np.random.default_rng(s))(5.0).q for s in (1, 1, 2))
    np.testing.assert_array_equal(one, same)
    assert not np.allclose(one, other)


def test_speed_zero_holds_still():
    _, v, a = dense(exciting_trajectory(load_robot("ur5"), np.random.default_rng(1), speed=0.0))
    np.testing.assert_array_equal(v, 0.0)
    np.testing.assert_array_equal(a, 0.0)


@pytest.mark.parametrize(
    "wrong", [{"duration": 0}, {"speed": 1.5}, {"speed": -1}, {"reach": 0}, {"harmonics": 0}, {"base": 0}]
)
def test_settings_out_of_range_are_refused(wrong):
    with pytest.raises(RobotError, match="exciting motion"):
        exciting_trajectory(load_robot("ur5"), np.random.default_rng(1), **wrong)
