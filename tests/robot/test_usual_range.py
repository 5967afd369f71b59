"""Postures are drawn from the range that a joint has, wherever that is."""

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.effects.weight import largest_weight
from cdia_pin.identifiability import distinguishing_motion
from cdia_pin.identifiability.structural_rank import random_states
from cdia_pin.robot import JointLimits
from cdia_pin.robot.collision import CollisionModel
from tests.one_joint import write_urdf

INF, PI = np.inf, np.pi
ELSEWHERE = [("revolute", 3.3, 6.0), ("revolute", -6.0, -3.3), ("prismatic", 4.0, 8.0)]


def usual_range(lower, upper, slides):
    unlimited = np.full(1, INF)
    limits = JointLimits(np.array([lower]), np.array([upper]), unlimited, unlimited)
    return tuple(float(end[0]) for end in limits.usual_range(np.array([slides])))


@pytest.mark.parametrize("slides", [False, True])
@pytest.mark.parametrize("own", [(-2.0, 2.5), (-0.1, 0.1), (0.5, 3.0)])
def test_a_range_within_half_a_turn_is_the_joints_own(own, slides):
    assert usual_range(*own, slides) == own


@pytest.mark.parametrize("slides", [False, True])
@pytest.mark.parametrize(
    ("own", "usual"),
    [
        ((-INF, INF), (-PI, PI)),
        ((-INF, 2.0), (-PI, 2.0)),
        ((-2.0, INF), (-2.0, PI)),
        ((5.0, INF), (5.0, 5 + PI)),
    ],
)
def test_an_end_that_is_not_stated_is_half_a_turn_away(own, usual, slides):
    assert usual_range(*own, slides) == usual


def test_a_joint_that_turns_stays_within_half_a_turn_of_zero():
    assert usual_range(-2 * PI, 2 * PI, slides=False) == (-PI, PI)
    assert usual_range(-0.0175, 3.7525, slides=False) == (-0.0175, PI)


def test_a_joint_that_turns_elsewhere_stays_within_half_a_turn_of_its_middle():
    assert usual_range(3.0, 6.0, slides=False) == (3.0, 6.0)
    assert usual_range(4.0, 14.0, slides=False) == (9.0 - PI, 9.0 + PI)


def test_a_long_slide_keeps_its_range():
    assert usual_range(-1.0, 6.0, slides=True) == (-1.0, 6.0)
    assert usual_range(4.0, 8.0, slides=True) == (4.0, 8.0)


@pytest.mark.parametrize(("kind", "lower", "upper"), ELSEWHERE)
def test_an_arm_that_moves_beyond_half_a_turn_is_judged_within_its_limits(kind, lower, upper, tmp_path):
    file = write_urdf(kind, tmp_path)
    text = file.read_text(encoding="utf-8")
    file.write_text(
        text.replace('lower="-2.5" upper="2.5"', f'lower="{lower}" upper="{upper}"'), encoding="utf-8"
    )
    arm = load_robot(file)
    q = random_states(arm).q
    assert lower <= q.min() < lower + 0.5 < upper - 0.5 < q.max() <= upper
    assert largest_weight(arm).shape == (1,)
    assert distinguishing_motion([[], []], arm)
    assert CollisionModel(arm).pairs == ()
