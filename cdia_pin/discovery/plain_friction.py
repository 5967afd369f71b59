"""The friction that every joint has comes before friction between two joints, and before friction under load.

Friction that follows the sum of two speeds has fewer parameters than friction of both joints. Where these often move
together, it stands for them, and the friction that every joint has would then be on neither. Where the load of a joint
hardly changes, friction under load is nearly the same torque as Coulomb friction, and stands for that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.run_to_run import is_friction_of_joint
from cdia_pin.discovery.certain_effects import with_certain
from cdia_pin.discovery.decision import Repeat
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import (
    AsymmetricFriction,
    CoulombFriction,
    CoupledFriction,
    Effect,
    LoadFriction,
    Term,
)
from cdia_pin.effects.load_stribeck import LoadStribeckFriction
from cdia_pin.effects.refinements import PLAIN_FRICTION
from cdia_pin.effects.traits import Signal
from cdia_pin.regression.cross_validation import held_out_rms
from cdia_pin.regression.gauss_newton import fitted_together
from cdia_pin.selection.problem import WhitenedProblem

Array = NDArray[np.float64]

UNDER_LOAD = (LoadFriction.name, LoadStribeckFriction.name)  # also where it differs between logs, or drifts
LEAST_ERROR = 1e-12  # [N·m or N], below every measured torque: a joint without error must not divide by zero


def with_plain_friction(problem: WhitenedProblem, model: Dynamics, given: Dynamics) -> Dynamics:
    """Return a model in which joints have friction of their own, rather than between two of them or under load alone.

    Friction between two joints stays if both have friction of their own, or if it is visible beside that and predicts
    them clearly better. Friction under load stays if it is visible beside Coulomb and viscous friction of its joint.

    Args:
        problem: The logs and their noise.
        model: The fitted model.
        given: The model before the discovery; its terms stay as they are.
    """
    if not problem.settings.may_find(kind.name for kind in PLAIN_FRICTION):
        return model
    known = {t.label for t in given.terms}
    for term in [t for t in model.terms if t.label not in known and _is_under_load_alone(t, model)]:
        model = _with_dry_friction(problem, model, term)
    rubbing = {t.effect.scope[0] for t in model.terms if is_friction_of_joint(t.effect)}
    between = [
        t
        for t in model.terms
        if isinstance(t.effect, CoupledFriction)
        and t.label not in known
        and not set(t.effect.scope) <= rubbing  # beside friction of both joints it stands for neither
    ]
    if not between:
        return model
    crowded = Repeat.of(problem.problem, model).crowded
    doubtful = [t for t in between if not crowded.is_visible(t)]
    if doubtful:
        model = _with_own_friction(problem, model, doubtful)
    for term in [t for t in between if t not in doubtful]:
        # where joints move in step, the fit beside all others may share its torque out in any way
        plain = _with_own_friction(problem, model, [term])
        growth = held_out_growth(problem, model, plain)[list(term.effect.acts_on(model.robot))]
        if growth.mean() <= problem.settings.confidence.worth_of_refinement:
            model = plain
    return model


def held_out_growth(problem: WhitenedProblem, model: Dynamics, plain: Dynamics) -> Array:
    """Return the held-out error of each joint with a plain model over that with another [1], shape (n,).

    Args:
        problem: The logs and their noise.
        model: The other model, fitted.
        plain: The plain model, fitted.
    """
    before, after = (
        np.maximum(held_out_rms(problem.regression, problem.experiment.predict(m)), LEAST_ERROR)
        for m in (model, plain)
    )
    return np.asarray(after / before)


def _with_own_friction(problem: WhitenedProblem, model: Dynamics, between: Sequence[Term]) -> Dynamics:
    """Return a model with certain friction of each joint in the place of friction between two."""
    rest = model.without({t.label for t in between})
    return with_certain(problem, rest, _of_each_joint(between, [t.effect for t in rest.terms]))


def _is_under_load_alone(term: Term, model: Dynamics) -> bool:
    """Tell whether a term is friction under load, and its joint has no other dry friction."""
    return term.effect.name in UNDER_LOAD and not any(
        is_friction_of_joint(t.effect)
        and t.effect.scope == term.effect.scope
        and Signal.DIRECTION in t.effect.traits.depends_on
        for t in model.terms
        if t is not term
    )


def _with_dry_friction(problem: WhitenedProblem, model: Dynamics, load: Term) -> Dynamics:
    """Return a model with Coulomb and viscous friction of a joint, beside friction under load if that is visible.

    Where only one of the two dry frictions can be told, it is Coulomb friction if that predicts about as well.
    """
    logs = problem.problem
    added = _of_each_joint([load], [t.effect for t in model.terms])
    plain = replace(model, terms=(*model.terms, *(Term(e, (0.0,)) for e in added)))
    plain = fitted_together(problem.regression, plain)
    if not Repeat.of(logs, plain).is_visible(plain.find(load.label)):
        plain = fitted_together(problem.regression, plain.remove(load.label))
    repeat = Repeat.of(logs, plain)
    unsure = {e.label for e in added if not repeat.survives(plain.find(e.label))}
    if CoulombFriction(*load.effect.scope).label in unsure:
        return _with_coulomb_alone(problem, model, load)
    return fitted_together(problem.regression, plain.without(unsure)) if unsure else plain


def _with_coulomb_alone(problem: WhitenedProblem, model: Dynamics, load: Term) -> Dynamics:
    """Return a model with Coulomb friction in the place of friction under load, if it predicts about as well."""
    coulomb = Term(CoulombFriction(*load.effect.scope), (0.0,))
    plain = fitted_together(problem.regression, model.remove(load.label).add(coulomb))
    growth = held_out_growth(problem, model, plain)[model.robot.joint_index(load.effect.scope[0])]
    return plain if growth <= problem.settings.confidence.worth_of_refinement else model


def _of_each_joint(terms: Sequence[Term], present: Sequence[Effect]) -> list[Effect]:
    """Return Coulomb and viscous friction of the joints of some terms that have none."""
    joints = dict.fromkeys(j for t in terms for j in t.effect.scope)
    own = {(e.name, e.scope) for e in present}  # also where it differs between logs, or drifts
    both = {e.scope[0] for e in present if e.name == AsymmetricFriction.name}
    effects: list[Effect] = [kind(j) for j in joints if j not in both for kind in PLAIN_FRICTION]
    return [e for e in effects if (e.name, e.scope) not in own]
