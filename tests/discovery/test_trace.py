"""The steps of an answer: what helps only beside another effect stays, what harms in any company goes.

No answer predicts worse than the model that was given.
"""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, Log, load_robot
from cdia_pin.discovery import doubted_effects, one_by_one
from cdia_pin.discovery import trace as tracing
from cdia_pin.effects import parse_term
from cdia_pin.regression.gauss_newton import fitted_together
from cdia_pin.selection import DiscoverySettings
from cdia_pin.selection.problem import Problem
from tests.made_logs import motion

COULOMB, VISCOUS = "coulomb_friction@joint2", "viscous_friction@joint2"
HIDDEN = tuple(map(parse_term, (f"{COULOMB}: level=0.3", f"{VISCOUS}: coefficient=0.1")))


@pytest.fixture(scope="module")
def found():
    """The problem of a log with two effects, and its model."""
    robot = load_robot("double_pendulum")
    t, q, v, a = motion(robot.n, 5, duration=24.0)
    effort = Dynamics(robot, HIDDEN).inverse_dynamics(q, v, a)
    effort += np.random.default_rng(0).normal(0.0, 0.02, effort.shape)
    logs = Problem.conditioned(robot, [Log(robot.joints, t, q, effort)], [], DiscoverySettings())
    problem = logs.around(Dynamics(robot)).with_first_noise(Dynamics(robot))
    return problem, fitted_together(problem.regression, Dynamics(robot, HIDDEN))


@pytest.fixture
def with_errors(monkeypatch):
    """A function that sets the held-out error of the models with one effect and with both; without any it is 1."""

    def set_errors(coulomb, viscous, both):
        errors = {(): 1.0, (COULOMB,): coulomb, (VISCOUS,): viscous, (COULOMB, VISCOUS): both}
        for module in (one_by_one, doubted_effects):
            monkeypatch.setattr(
                module, "heldout_error", lambda _, m: errors[tuple(sorted(t.label for t in m.terms))]
            )

    return set_errors


@pytest.mark.parametrize(
    ("coulomb", "viscous", "both", "stay"),
    [
        (0.5, 0.6, 0.1, {COULOMB, VISCOUS}),
        (1.2, 1.3, 0.1, {COULOMB, VISCOUS}),  # either alone harms
        (0.5, 1.2, 0.6, {COULOMB}),
        (1.2, 1.2, 1.3, set()),
        (1.2, 1.3, 1.1, set()),  # each helps beside the other, and both predict worse than neither
    ],
)
def test_an_effect_stays_if_it_lowers_the_error_in_some_company(
    found, with_errors, coulomb, viscous, both, stay
):
    problem, model = found
    with_errors(coulomb, viscous, both)
    final, steps = tracing.trace(problem, Dynamics(model.robot), model)
    assert {t.label for t in final.terms} == stay
    assert {s.term.label for s in steps if s.term} == stay


def test_what_is_forced_stays_though_it_harms(found, with_errors):
    problem, model = found
    with_errors(1.2, 1.3, 1.1)
    final, _ = tracing.trace(problem, Dynamics(model.robot), model, (VISCOUS,))
    assert {t.label for t in final.terms} == {VISCOUS}


@pytest.mark.parametrize(
    ("coulomb", "viscous", "both", "harm"),
    [
        (0.5, 0.6, 0.1, set()),
        (1.2, 1.3, 0.9, set()),  # both together predict better than the model that was given
        (0.5, 0.6, 1.1, {VISCOUS}),
        (1.2, 1.3, 1.1, {COULOMB, VISCOUS}),
    ],
)
def test_effects_that_make_a_model_predict_worse_than_the_given_one_are_searched_without(
    found, with_errors, coulomb, viscous, both, harm
):
    problem, model = found
    with_errors(coulomb, viscous, both)
    assert doubted_effects.harmful(problem, model, Dynamics(model.robot)) == harm


def test_the_last_model_is_the_found_one_where_the_fits_before_it_end_in_another_optimum(found, monkeypatch):
    problem, model = found
    whole = one_by_one.heldout_error(problem, model)

    def elsewhere(regression, model, *_):
        """Return a model as it is if it has both effects; one alone is fitted to another optimum."""
        factor = 1.0 if len(model.terms) > 1 else 1.5
        return replace(model, terms=tuple(t.with_theta(factor * np.array(t.theta)) for t in model.terms))

    monkeypatch.setattr(one_by_one, "fitted_together", elsewhere)
    last = one_by_one.kept(problem, Dynamics(model.robot), model)[-1]
    assert {t.label for t in last.model.terms} == {COULOMB, VISCOUS}
    assert last.error == whole
