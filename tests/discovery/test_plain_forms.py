"""Plain forms: where structure is left in any case, a refinement must predict its joint clearly better."""

import numpy as np
import pytest

from cdia_pin import Dynamics, Log, load_robot
from cdia_pin.discovery.plain_forms import with_plain_forms
from cdia_pin.effects import CoulombFriction, Term, parse_term
from cdia_pin.effects.drift import Drift
from cdia_pin.regression.gauss_newton import fitted_together
from cdia_pin.selection import DiscoverySettings
from cdia_pin.selection.problem import Problem
from tests.made_logs import motion

LEVEL = 0.3


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


def named(robot, refined, torque, effects=None, *, bump=0.0, bumpy=1, noise=0.01):
    """Return the names that a refined effect ends with, beside a torque and perhaps a bump that has no name."""
    terms = plain(robot, parse_term(refined), torque, effects, bump=bump, bumpy=bumpy, noise=noise).terms
    return {t.effect.name for t in terms}


def plain(robot, refined, torque, effects=None, *, bump=0.0, bumpy=1, noise=0.01):
    """Return the model that a term ends in, on a log with a torque and perhaps a bump that has no name."""
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    effort = Dynamics(robot).inverse_dynamics(q, v, a)
    effort[:, 1] += torque(v[:, 1])
    effort[:, bumpy] += bump * np.exp(-(((q[:, bumpy] - np.median(q[:, bumpy])) / 0.15) ** 2))
    effort += np.random.default_rng(0).normal(0.0, noise, effort.shape)
    settings = DiscoverySettings(effects=effects)
    logs = Problem.conditioned(robot, [Log(robot.joints, t, q, effort)], [], settings)
    problem = logs.around(Dynamics(robot)).with_first_noise(Dynamics(robot))
    found = fitted_together(problem.regression, Dynamics(robot, (refined,)))
    return with_plain_forms(problem, found, Dynamics(robot))


def symmetric(v):
    return LEVEL * np.sign(v)


def asymmetric(v):
    return LEVEL * np.sign(v) + np.where(v > 0, 1.6, 0.4) * v


def with_an_offset(v):
    return np.where(v > 0, 1.5, 0.5) * LEVEL * np.sign(v)


ASYMMETRIC = "asymmetric_friction@joint2: level_positive=0.3, level_negative=0.3"
BRISTLES = "presliding_friction@joint2: level=0.3"
SPRING = "joint_spring@joint2: stiffness=0.01, preload=0.3"


@pytest.mark.parametrize("bump", [0.0, 0.3])
def test_friction_that_is_the_same_in_both_directions_is_not_asymmetric(robot, bump):
    assert "asymmetric_friction" not in named(robot, ASYMMETRIC, symmetric, bump=bump)


@pytest.mark.parametrize("bump", [0.0, 0.1])
def test_friction_that_differs_between_the_directions_stays_asymmetric(robot, bump):
    assert named(robot, ASYMMETRIC, asymmetric, bump=bump) == {"asymmetric_friction"}


def test_beside_structure_a_level_of_its_own_each_way_is_one_level_and_an_offset(robot):
    assert named(robot, ASYMMETRIC, with_an_offset, bump=0.1) == {"coulomb_friction", "torque_offset"}


@pytest.mark.parametrize(
    ("refined", "torque", "plain"),
    [(BRISTLES, symmetric, "coulomb_friction"), (SPRING, lambda v: LEVEL + 0 * v, "torque_offset")],
)
def test_beside_structure_the_plain_name_is_given(robot, refined, torque, plain):
    assert named(robot, refined, torque, bump=0.3) == {plain}


def test_a_small_refinement_stays_if_it_leaves_nothing(robot):
    def little(v):
        return np.where(v > 0, 0.52, 0.28) * np.sign(v)

    assert named(robot, ASYMMETRIC, little, noise=0.4) == {"asymmetric_friction"}
    plain = {"coulomb_friction", "torque_offset"}
    assert named(robot, ASYMMETRIC, little, noise=0.4, bump=1.5) == plain
    assert named(robot, ASYMMETRIC, little, noise=0.4, bump=1.5, bumpy=0) == plain  # on another joint


@pytest.mark.parametrize(("fall", "noise", "drifts"), [(0.2, 0.1, True), (0.2, 0.3, True), (0.0, 0.1, False)])
def test_friction_that_falls_within_the_log_drifts_and_constant_friction_does_not(robot, fall, noise, drifts):
    def falling(v):
        return np.linspace(2.0, 2.0 * (1 - fall), len(v)) * np.sign(v)

    drift = Term(Drift(CoulombFriction("joint2"), 0.0, 24.0, 48.0), (2.0, 2.0))
    (term,) = plain(robot, drift, falling, noise=noise).terms
    assert (term.label == drift.label) is drifts


def test_nothing_is_named_that_the_user_did_not_ask_for(robot):
    assert named(robot, BRISTLES, symmetric, ("presliding_friction",), bump=0.3) == {"presliding_friction"}


def test_what_the_model_had_stays(robot):
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    logs = Problem.conditioned(
        robot, [Log(robot.joints, t, q, Dynamics(robot).inverse_dynamics(q, v, a))], [], DiscoverySettings()
    )
    given = Dynamics(robot, (parse_term(BRISTLES),))
    assert with_plain_forms(logs.around(given).with_first_noise(given), given, given) is given
