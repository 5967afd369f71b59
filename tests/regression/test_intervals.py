"""Intervals of parameters that physical limits hold."""

import numpy as np
import pytest

from cdia_pin import Dynamics, discover, load_robot
from cdia_pin.logs import Log
from tests.made_logs import motion
from tests.one_joint import write_urdf


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    return load_robot(write_urdf("revolute", tmp_path_factory.mktemp("arm")))


def test_a_mass_that_only_physical_limits_hold_may_be_nothing(robot):
    """A controller's torque against gravity shows less inertia than the arm has, and more first moment."""
    t, q, *_ = motion(1, 3, duration=24.0)
    effort = 1.1 * robot.gravity(q) + np.random.default_rng(0).normal(0.0, 0.02, q.shape)
    found = discover(Dynamics(robot), Log(robot.joints, t, q, effort))
    bodies = [s.term for s in found.steps if s.term.effect.bodies]
    assert bodies
    for term in bodies:
        low, high = term.ci95[[p.name for p in term.effect.parameters].index("mass")]
        assert low < 0.0 < high
