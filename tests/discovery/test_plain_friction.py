"""The friction that every joint has comes before friction between two joints, and before friction under load."""

import numpy as np
import pytest

from cdia_pin import Dynamics, Log, load_robot
from cdia_pin.discovery.missing_effects import PLAINER
from cdia_pin.discovery.plain_forms import with_plain_forms
from cdia_pin.discovery.plain_friction import _of_each_joint, with_plain_friction
from cdia_pin.effects import CoulombFriction, PerLog, ViscousFriction, parse_term
from cdia_pin.regression.gauss_newton import fitted_together
from cdia_pin.selection import DiscoverySettings
from cdia_pin.selection.problem import Problem
from tests.made_logs import motion

WEIGHT = 3.0  # [N·m], constant load of the joint


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


def named(robot, found, torque, *, given=()):
    """Return the terms that a found effect ends with, where a joint of constant load and some torque is measured."""
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    body = Dynamics(robot).inverse_dynamics(q, v, a)
    effort = body + np.random.default_rng(0).normal(0.0, 0.03, body.shape)
    effort[:, 1] += torque(v[:, 1], body[:, 1])
    known = Dynamics(robot, tuple(map(parse_term, given)))
    log = Log(robot.joints, t, q, effort)
    problem = Problem.conditioned(robot, [log], [], DiscoverySettings()).around(known).with_first_noise(known)
    model = fitted_together(problem.regression, known.add(parse_term(found)))
    return with_plain_friction(problem, model, known)


def labels(model):
    return {t.label for t in model.terms}


def test_friction_of_each_joint_comes_before_friction_between_two(robot):
    shared = "coupled_friction@joint1+joint2: coefficient=0.0, level=0.1"
    plain = named(robot, shared, lambda v, _: 0.3 * np.sign(v))
    assert labels(plain) == {"coulomb_friction@joint2"}
    assert plain.find("coulomb_friction@joint2").theta == pytest.approx((0.3,), rel=0.05)


def test_what_was_given_stays(robot):
    shared = "coupled_friction@joint1+joint2: coefficient=0.0, level=0.1"
    assert labels(named(robot, shared, lambda v, _: 0.3 * np.sign(v), given=(shared,))) == {
        "coupled_friction@joint1+joint2"
    }


@pytest.mark.parametrize(
    "found",
    [
        "load_friction@joint2: coefficient=0.1",
        "load_stribeck_friction@joint2: coefficient=0.1, breakaway=0.02, decay=10",
    ],
)
def test_where_the_load_hardly_changes_dry_friction_is_coulomb_friction(robot, found):
    weight = f"torque_offset@joint2: offset={WEIGHT}"
    plain = named(robot, found, lambda v, _: WEIGHT + 0.3 * np.sign(v), given=(weight,))
    assert "coulomb_friction@joint2" in labels(plain)
    assert parse_term(found).label not in labels(plain)


def test_the_plain_form_of_friction_under_load_may_stand_for_coulomb_friction_too():
    assert with_plain_friction in PLAINER[PLAINER.index(with_plain_forms) :]


def test_friction_that_follows_the_load_stays(robot):
    found = named(
        robot,
        "load_friction@joint2: coefficient=0.3",
        lambda v, load: 0.3 * np.abs(load) * np.sign(v),
    )
    assert "load_friction@joint2" in labels(found)


def test_friction_that_differs_between_logs_is_not_added_again(robot):
    per_log = PerLog(ViscousFriction("joint2"), ("a", "b"))
    assert _of_each_joint([parse_term("load_friction@joint2: coefficient=0.1")], [per_log]) == [
        CoulombFriction("joint2")
    ]
