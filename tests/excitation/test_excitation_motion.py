"""Motions to choose from keep within positions, speeds and accelerations, and begin and end at rest."""

import numpy as np
import pytest

from cdia_pin.errors import RobotError
from cdia_pin.excitation import motion_limits
from cdia_pin.excitation.motion import Draw
from cdia_pin.robot import load_robot

ARMS = ("ur5", "panda", "scara", "kinova", "double_pendulum")


@pytest.fixture(params=ARMS, scope="module")
def robot(request):
    return load_robot(request.param)


def draws(robot, limits, count=3):
    rng = np.random.default_rng(5)
    for _ in range(count):
        drawn = Draw.random(limits.middle + 0.3 * limits.half * rng.uniform(-1, 1, robot.n), rng)
        yield drawn
        yield drawn.varied(0.5, limits, rng)


def test_every_draw_is_within_its_limits(robot):
    limits = motion_limits(robot)
    time = np.arange(0.0, 20.0, 1e-3)
    for drawn in draws(robot, limits):
        q, v, a = drawn.trajectory(20.0, limits)(time)
        assert (q >= limits.lower).all()
        assert (q <= limits.upper).all()
        assert (np.abs(v) <= limits.velocity).all()
        assert (np.abs(a) <= limits.acceleration).all()


def test_it_begins_and_ends_at_rest_in_one_posture(robot):
    limits = motion_limits(robot)
    for drawn in draws(robot, limits):
        motion = drawn.trajectory(20.0, limits)
        assert motion.duration == pytest.approx(20.0)
        for at in (0.0, motion.duration):
            q, v, a = motion(at)
            np.testing.assert_allclose(q, drawn.centre, atol=1e-12)
            np.testing.assert_allclose([v, a], 0.0, atol=1e-9)


def test_speeds_and_accelerations_are_its_derivatives(robot):
    limits = motion_limits(robot)
    step = 1e-4
    time = np.arange(0.5, 19.5, 0.01)
    for drawn in draws(robot, limits, 1):
        motion = drawn.trajectory(20.0, limits)
        before, now, after = (motion(time + d) for d in (-step, 0.0, step))
        np.testing.assert_allclose((after.q - before.q) / (2 * step), now.v, atol=1e-5)
        np.testing.assert_allclose((after.v - before.v) / (2 * step), now.a, atol=1e-3)


def test_a_draw_uses_the_limits_it_has():
    robot = load_robot("ur5")
    limits = motion_limits(robot)
    used = []
    for drawn in draws(robot, limits):
        _, v, a = drawn.trajectory(20.0, limits)(np.arange(0.0, 20.0, 0.01))
        used.append(np.maximum(np.abs(v) / limits.velocity, np.abs(a) / limits.acceleration).max())
    assert max(used) > 0.8


def test_smaller_is_the_same_motion_closer_to_its_posture():
    robot = load_robot("ur5")
    limits = motion_limits(robot)
    drawn = next(draws(robot, limits))
    time = np.arange(0.0, 20.0, 0.01)
    whole, half = (d.trajectory(20.0, limits)(time).q - drawn.centre for d in (drawn, drawn.smaller(0.5)))
    np.testing.assert_allclose(half, 0.5 * whole, atol=1e-12)


def test_limits_are_those_of_the_urdf_less_a_margin():
    robot = load_robot("panda")
    limits = motion_limits(robot, speed=0.5, effort=0.6)
    np.testing.assert_allclose(limits.velocity, 0.5 * robot.limits.velocity)
    np.testing.assert_allclose(limits.effort, 0.6 * robot.limits.effort)
    assert (limits.lower > robot.limits.lower).all()
    assert (limits.upper < robot.limits.upper).all()
    np.testing.assert_allclose(limits.acceleration, limits.velocity / 0.5)
    assert limits.assumed == ()


def test_accelerations_are_given_for_all_or_by_joint():
    robot = load_robot("panda")
    assert (motion_limits(robot, acceleration=3.0).acceleration == 3.0).all()
    by_joint = motion_limits(robot, acceleration={"panda_joint3": 1.0}).acceleration
    usual = motion_limits(robot).acceleration
    assert by_joint[2] == 1.0
    assert np.array_equal(np.delete(by_joint, 2), np.delete(usual, 2))


def test_what_the_urdf_does_not_state_is_said(tmp_path):
    text = (load_robot("double_pendulum").urdf).read_text(encoding="utf-8")
    file = tmp_path / "silent.urdf"
    file.write_text(text, encoding="utf-8")
    limits = motion_limits(load_robot(file))  # the file itself states neither speeds nor efforts
    assert (limits.velocity == 1.0).all()
    assert np.isinf(limits.effort).all()
    said = " ".join(limits.assumed)
    assert "velocity" in said
    assert "effort" in said
    assert "joint1" in said


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"speed": 0.0}, "shares of the speed"),
        ({"effort": 1.5}, "shares of the speed"),
        ({"acceleration": 0.0}, "acceleration"),
        ({"acceleration": {"nothing": 1.0}}, "unknown joint"),
        ({"acceleration": float("nan")}, "acceleration"),
    ],
)
def test_settings_out_of_range_are_refused(given, said):
    with pytest.raises(RobotError, match=said):
        motion_limits(load_robot("ur5"), **given)


def test_a_joint_without_room_is_refused(tmp_path):
    text = load_robot("scara").urdf.read_text(encoding="utf-8")
    slide = 'lower="0" upper="0.200"'
    assert slide in text
    file = tmp_path / "stiff.urdf"
    file.write_text(text.replace(slide, 'lower="0" upper="0.001"'), encoding="utf-8")
    with pytest.raises(RobotError, match="joint4 leave no room"):
        motion_limits(load_robot(file))
