"""The friction that every joint has comes before friction between two joints, and before friction under load."""

import numpy as np
import pytest

from cdia_pin import Dynamics, Log, load_robot
from cdia_pin.discovery.decision import Repeat
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


IN_STEP = 0.05  # share of its own motion [1] by which the second joint leaves the first one's


def with_friction_between(robot, friction, *, alike=1.0, own=IN_STEP):
    """Return the terms that friction between two joints ends with, where friction of some law is measured on both."""
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    q, v, a = (np.column_stack([x[:, 0], alike * x[:, 0] + own * x[:, 1]]) for x in (q, v, a))
    effort = Dynamics(robot).inverse_dynamics(q, v, a) + friction(v)
    effort += np.random.default_rng(0).normal(0.0, 0.03, effort.shape)
    known = Dynamics(robot)
    log = Log(robot.joints, t, q, effort)
    problem = Problem.conditioned(robot, [log], [], DiscoverySettings()).around(known).with_first_noise(known)
    shared = parse_term("coupled_friction@joint1+joint2: coefficient=0.1, level=0.1")
    return with_plain_friction(problem, fitted_together(problem.regression, known.add(shared)), known)


def test_friction_of_joints_that_move_in_step_is_their_own_also_where_the_fit_beside_all_others_shows_more(
    robot, monkeypatch
):
    # as on measured legs, where that fit finds a level below zero, or twice the model's
    monkeypatch.setattr(Repeat, "is_visible", lambda *_: True)
    own = with_friction_between(robot, lambda v: 0.3 * np.sign(v) + 0.2 * v)
    kinds = ("coulomb_friction", "viscous_friction")
    assert labels(own) == {f"{kind}@{joint}" for kind in kinds for joint in robot.joints}


def test_friction_between_two_joints_stays_if_friction_of_each_predicts_them_worse(robot, monkeypatch):
    monkeypatch.setattr(Repeat, "is_visible", lambda *_: True)

    def between(v):
        return np.repeat(0.3 * np.sign(v.sum(axis=1, keepdims=True)), 2, axis=1)

    found = with_friction_between(robot, between, alike=0.0, own=1.0)
    assert labels(found) == {"coupled_friction@joint1+joint2"}


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
