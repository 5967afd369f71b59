"""Unusual effects: certain ones stay, others leave a model that predicts as well without them."""

import numpy as np
import pytest

from cdia_pin import Dynamics, Log, load_robot
from cdia_pin.discovery.doubted_effects import doubted, predicts_as_well
from cdia_pin.effects import parse_term
from cdia_pin.regression.gauss_newton import fitted_together
from cdia_pin.selection import DiscoverySettings
from cdia_pin.selection.problem import Problem
from tests.made_logs import motion

FRICTION = parse_term("coulomb_friction@joint2: level=0.3")
SPRING = "counterbalance@joint1: torque_at_centre=2.0, torque_opposite=1.0"


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


def fitted(robot, hidden, settings=None):
    """Return the problem of a log, the model with friction and a counterbalance, and the one with friction alone."""
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    noise = np.random.default_rng(0).normal(0.0, 0.05, q.shape)
    effort = Dynamics(robot, (FRICTION, *hidden)).inverse_dynamics(q, v, a) + noise
    logs = Problem.conditioned(robot, [Log(robot.joints, t, q, effort)], [], settings or DiscoverySettings())
    problem = logs.around(Dynamics(robot)).with_first_noise(Dynamics(robot))
    models = (Dynamics(robot, (FRICTION, parse_term(SPRING))), Dynamics(robot, (FRICTION,)))
    return problem, *(fitted_together(problem.regression, m) for m in models)


def test_what_is_not_there_is_doubted_and_not_missed(robot):
    problem, found, plain = fitted(robot, ())
    assert doubted(problem, found, Dynamics(robot)) == {"counterbalance@joint1"}
    assert predicts_as_well(problem, plain, found)


def test_what_is_there_is_missed(robot):
    problem, found, plain = fitted(robot, (parse_term(SPRING),))
    assert not predicts_as_well(problem, plain, found)


def test_what_the_user_expects_or_has_given_is_not_doubted(robot):
    problem, found, _ = fitted(robot, (), DiscoverySettings(expected=("counterbalance",)))
    assert doubted(problem, found, Dynamics(robot)) == set()
    problem, found, _ = fitted(robot, ())
    assert doubted(problem, found, found) == set()
