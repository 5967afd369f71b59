"""Drive gains that are wrong together: they come before bodies that imitate them, and masses that are wrong stay."""

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.discovery.drive_gains import costs_less, with_drive_gains
from tests.bumped_arms import bumped

LINKS = ("link_inertia@joint1: mass=0.1", "link_inertia@joint2: mass=0.1")
UNLIKE = (0.6, 1.5)  # what the drives report over what they give [1]; no masses do that
ALIKE = (0.6, 0.55)


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


def found_and_gains(robot, scale, hidden=(), found=LINKS, given=(), effects=None, bump=0.15):
    """Return the problem, a found model with bodies, and what takes its place on an arm with a bump without a name."""
    problem, model, before = bumped(robot, hidden, found, given, effects, bump, scale)
    return problem, model, with_drive_gains(problem, model, before)


@pytest.mark.parametrize("scale", [UNLIKE, UNLIKE[::-1]])
def test_gains_take_the_place_of_bodies_that_imitate_them(robot, scale):
    problem, found, model = found_and_gains(robot, scale, bump=0.1)
    assert {t.label for t in model.terms} == {"actuator_gain@joint1", "actuator_gain@joint2"}
    sizes = [model.find(f"actuator_gain@{j}").theta[0] for j in robot.joints]
    np.testing.assert_allclose(sizes, 1 / np.array(scale) - 1, atol=0.1)  # a part of the bump is in them
    assert costs_less(problem, model, found)
    assert not costs_less(problem, found, model)


def test_drives_that_are_wrong_alike_are_as_masses_are(robot):
    assert found_and_gains(robot, ALIKE)[2] is None


@pytest.mark.parametrize(
    "wrong",
    ["payload: mass=0.5, first_moment_z=-0.05", "link_inertia@joint2: mass=0.5, first_moment_x=0.1"],
)
def test_masses_that_are_wrong_stay(robot, wrong):
    assert found_and_gains(robot, (1.0, 1.0), [wrong])[2] is None


def test_bodies_of_an_arm_that_they_explain_wholly_stay(robot):
    wrong = ["link_inertia@joint2: mass=0.5, first_moment_x=0.1, first_moment_z=-0.2"]
    assert found_and_gains(robot, (1.0, 1.0), wrong, found=LINKS[1:], bump=0.0)[2] is None


def test_what_the_model_had_or_nobody_asked_for_stays(robot):
    assert found_and_gains(robot, UNLIKE, found=(), given=LINKS)[2] is None
    assert found_and_gains(robot, UNLIKE, effects=("link_inertia",))[2] is None
