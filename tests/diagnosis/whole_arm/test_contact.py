"""Contact from deviations: several joints at once, faster than a healthy arm."""

from __future__ import annotations

import numpy as np
import pytest

from cdia_pin.diagnosis.whole_arm.contact import ContactDetector, ContactLimits
from cdia_pin.diagnosis.whole_arm.wrench import located
from cdia_pin.robot import load_robot

DT = 0.01
LIMITS = ContactLimits(rest=np.full(3, 0.5), moving=np.full(3, 1.0), friction=np.full(3, 2.0))


def watched(
    remainders: np.ndarray,
    moving: np.ndarray | float = 1.0,
    load: np.ndarray | float = 0.0,
    believed: np.ndarray | float = 0.0,
) -> list[bool]:
    """Feed a detector a series; return whether there was contact at each sample."""
    detector, out = ContactDetector(LIMITS), []
    share, loads, torques = (np.broadcast_to(x, remainders.shape) for x in (moving, load, believed))
    for k, remainder in enumerate(remainders):
        detector.add(k * DT, DT, remainder, share[k], loads[k], torques[k])
        out.append(detector.present)
    return out


def pushed(joints: list[int], size: float, count: int = 400) -> np.ndarray:
    """A remainder of 0.1 on all joints, and a push of a second on some from 1 s on."""
    out = np.full((count, 3), 0.1)
    out[100:200, joints] += size
    return out


def test_a_push_on_two_joints_is_contact_at_once_and_gone_when_it_is_gone() -> None:
    said = watched(pushed([0, 1], 3.0))
    assert not any(said[:100])
    assert all(said[105:200])
    assert not any(said[205:])


def test_what_is_believed_may_miss_a_share_of_its_torque() -> None:
    """A load of 15 N·m may be 3 N·m off, and a hand of twice that is one."""
    assert not any(watched(pushed([0, 1], 3.0), believed=15.0))
    assert all(watched(pushed([0, 1], 6.0), believed=15.0)[105:200])


def test_other_numbers_of_what_is_believed_hide_no_hand() -> None:
    """Before, each update of a load took the present remainder as usual, and a light push beside it was not said."""
    detector, said, none = ContactDetector(LIMITS), [], np.zeros(3)
    series = pushed([0], 1.5) + pushed([1], 0.9)
    for k, remainder in enumerate(series):
        if k % 100 == 50:
            series[k:] += 0.1
            detector.shift(np.full(3, 0.1))
        detector.add(k * DT, DT, remainder, np.ones(3), none, none)
        said.append(detector.present)
    assert all(said[110:150])


def test_a_hand_that_stays_after_an_impact_is_still_there() -> None:
    series = np.full((900, 3), 0.1)
    series[100:110, :2] += 60.0
    series[110:500, :2] += 15.0
    said = watched(series)
    assert all(said[105:500])
    assert not any(said[510:])


@pytest.mark.parametrize("joints", [[0], [2]])
def test_one_joint_alone_is_no_contact(joints: list[int]) -> None:
    assert not any(watched(pushed(joints, 5.0)))


def test_joints_that_leave_one_after_the_other_are_no_contact() -> None:
    series = np.full((600, 3), 0.1)
    series[100:, 0] += 3.0
    series[200:, 1] += 3.0  # a second later
    assert not any(watched(series))


def test_a_slow_change_is_no_contact() -> None:
    slow = np.linspace(0.0, 8.0, 2000)[:, None] * np.ones(3)  # 0.4 a second, within 2 s less than its limit
    assert not any(watched(slow))


def test_at_rest_less_is_enough() -> None:
    assert not any(watched(pushed([0, 1], 0.8), moving=1.0))
    assert any(watched(pushed([0, 1], 0.8), moving=0.0))


def test_a_joint_that_starts_may_be_off_by_its_friction() -> None:
    starting = np.zeros((400, 3))
    starting[100:] = 1.0
    starting[100:110] = np.linspace(0.05, 0.95, 10)[:, None]
    friction = np.zeros((400, 3))
    friction[100:] = 1.8
    assert not any(watched(friction, starting))
    assert any(watched(friction, 1.0))


def test_at_rest_friction_takes_up_what_the_load_changes() -> None:
    push = pushed([0, 1], 0.8)
    assert not any(watched(push, moving=0.0, load=-push))


@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_the_link_and_the_force_of_a_push_are_found(name: str) -> None:
    robot, rng = load_robot(name), np.random.default_rng(4)
    found = 0
    for _ in range(20):
        q = rng.uniform(-1.5, 1.5, robot.n)
        force = rng.normal(size=3)
        force *= 30.0 / np.linalg.norm(force)
        jacobians = robot.link_end_jacobians(q)
        touch = located(jacobians[robot.n - 1, :3].T @ force, np.ones(robot.n), jacobians)
        assert touch.misfit < 0.5
        found += np.linalg.norm(touch.force - force) < 3.0
    assert found >= 15  # some postures show two directions only
