"""A body at the end of the arm: a payload where its weight shows, the last link where only its inertia does."""

import pytest

from cdia_pin import load_robot
from cdia_pin.discovery.weighed_payload import with_weighed_payload
from tests.bumped_arms import bumped

FOUND = ("payload: mass=0.1",)
LOAD = "payload: mass=0.5, first_moment_z=-0.1, inertia_xx=0.03, inertia_yy=0.03, inertia_zz=0.01"
# as of a link that nobody has measured
INERTIA = "payload: inertia_xx=0.05, inertia_yy=0.05, inertia_zz=0.05"


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


def named(robot, hidden, found=FOUND, given=(), effects=None):
    """Return the effects that a found model ends with; it leaves as much as the found one."""
    problem, model, before = bumped(robot, [hidden], found, given, effects, 0.0)
    now = with_weighed_payload(problem, model, before)
    assert problem.problem.rms(now) == pytest.approx(problem.problem.rms(model), rel=0.02)
    labels = [t.label for t in now.terms]
    assert len(labels) == len(set(labels))
    return set(labels)


def test_a_load_is_a_payload(robot):
    assert named(robot, LOAD) == {"payload"}


def test_an_inertia_without_a_weight_is_the_links(robot):
    assert named(robot, INERTIA) == {"link_inertia@joint2"}


def test_beside_the_last_link_it_is_one_body_with_it(robot):
    both = (*FOUND, "link_inertia@joint2: mass=0.05")
    assert named(robot, INERTIA, found=both) == {"link_inertia@joint2"}
    assert named(robot, LOAD, found=both) == {"payload"}


def test_what_the_model_had_or_nobody_asked_for_stays(robot):
    assert named(robot, INERTIA, found=(), given=FOUND) == {"payload"}
    assert named(robot, INERTIA, effects=("payload",)) == {"payload"}
    link = "link_inertia@joint2"
    assert named(robot, INERTIA, given=(f"{link}: mass=0.05",)) == {"payload", link}
