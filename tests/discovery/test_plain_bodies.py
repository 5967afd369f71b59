"""Plain bodies: a body gives way to rotors and offsets that predict as well, and stays where masses are wrong."""

import pytest

from cdia_pin import load_robot
from cdia_pin.discovery.plain_bodies import with_plain_bodies
from tests.bumped_arms import bumped

LINK = "link_inertia@joint2: mass=0.1"
ROTORS = ("rotor_inertia@joint1", "rotor_inertia@joint2")


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


def named(robot, hidden, found=(LINK,), given=(), effects=None, bump=0.3):
    """Return the effects that a found model ends with, on an arm with hidden effects and a bump that has no name."""
    return {t.label for t in with_plain_bodies(*bumped(robot, hidden, found, given, effects, bump)).terms}


def test_a_body_that_follows_rotors_gives_way_to_them(robot):
    hidden = [f"{ROTORS[0]}: inertia=0.2", f"{ROTORS[1]}: inertia=0.1"]
    names = named(robot, hidden)  # an offset may follow the mean of the bump
    assert names >= set(ROTORS)
    assert "link_inertia@joint2" not in names


def test_a_body_stays_on_an_arm_that_it_explains_wholly(robot):
    hidden, found = [f"{ROTORS[0]}: inertia=0.2"], ("link_inertia@joint1: mass=0.1",)
    assert named(robot, hidden, found, bump=0.0) == {"link_inertia@joint1"}
    assert named(robot, hidden, found, bump=0.3) >= {ROTORS[0]}


@pytest.mark.parametrize(("mass", "stays"), [(0.015, False), (0.03, True)])
def test_a_body_must_predict_three_percent_better(robot, mass, stays):
    wrong = f"link_inertia@joint2: mass={mass}, first_moment_x={mass / 5}, first_moment_z={-mass / 3}"
    assert ("link_inertia@joint2" in named(robot, [wrong])) == stays


def test_a_link_that_is_wrong_stays(robot):
    assert named(robot, ["link_inertia@joint2: mass=0.5, first_moment_x=0.1, first_moment_z=-0.2"]) == {
        "link_inertia@joint2"
    }


def test_what_the_model_had_or_nobody_asked_for_stays(robot):
    hidden = [f"{ROTORS[0]}: inertia=0.2"]
    assert named(robot, hidden, found=(), given=(LINK,)) == {"link_inertia@joint2"}
    assert named(robot, hidden, effects=("link_inertia",)) == {"link_inertia@joint2"}
