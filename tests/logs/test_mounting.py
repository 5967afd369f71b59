"""A base that stands otherwise than in the URDF is found by its gravity, and nothing else is taken for it."""

import re
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from cdia_pin.logs import check_log
from cdia_pin.logs.checks.motion import motion_of
from cdia_pin.logs.checks.mounting import gravity_elsewhere

WALL, CEILING, TILTED = (9.81, 0.0, 0.0), (0.0, 0.0, 9.81), (4.9, 0.0, -8.5)


@pytest.mark.parametrize("name", ["ur5", "panda"])
@pytest.mark.parametrize("gravity", [WALL, CEILING, TILTED])
def test_the_mounting_is_said_and_is_the_only_problem(name, gravity, plant, request):
    robot = request.getfixturevalue(name)
    (found,) = check_log(plant(robot.with_gravity(gravity)), robot).problems
    assert found.topic == "mounting"
    assert found.severity == ("warning" if gravity is TILTED else "error")
    roll, pitch, yaw = map(float, re.search(r'rpy="(\S+) (\S+) (\S+)"', found.advice).groups())
    there = pin.rpy.rpyToMatrix(roll, pitch, yaw).T @ robot.gravity_vector
    assert there == pytest.approx(np.array(gravity), abs=0.3)


def test_a_search_is_offered_only_where_it_can_fit_the_tilt(ur5, plant):
    advice = {g: check_log(plant(ur5.with_gravity(g)), ur5).problems[0].advice for g in (WALL, TILTED)}
    assert "--mounted tilted" in advice[TILTED]
    assert "--mounted" not in advice[WALL]


def test_gravity_that_is_compensated_is_not_another_mounting(panda, panda_log):
    without = replace(panda_log, effort=panda_log.effort - panda.gravity(panda_log.position))
    check = check_log(without, panda)
    assert not check.about("mounting")
    assert "gravity-compensated" in check.about("effort_kind")[0].message


@pytest.mark.parametrize("reversed_joints", [(1, 2), (1, 2, 3), (0, 1, 2)])
def test_efforts_of_other_signs_are_not_another_mounting(ur5, ur5_log, reversed_joints):
    effort = ur5_log.effort.copy()
    effort[:, reversed_joints] *= -1
    motion = motion_of(replace(ur5_log, effort=effort), ur5.is_prismatic)
    assert gravity_elsewhere(motion, ur5) is None


def test_a_payload_is_not_another_mounting(ur5, ur5_log):
    weight = np.array([0.0, 0.0, -9.81 * 8.0, 0.0, 0.0, 0.0])
    loaded = ur5_log.effort - np.einsum("nij,i->nj", ur5.tool_jacobian(ur5_log.position), weight)
    assert not check_log(replace(ur5_log, effort=loaded), ur5).about("mounting")


def test_measured_arms_stand_as_their_urdf_says(measured):
    from benchmarks.measured_logs.cases import cases

    for case in cases(measured):
        assert not check_log(case.fitted, case.robot).about("mounting"), case.name
