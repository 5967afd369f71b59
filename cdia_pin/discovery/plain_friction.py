"""Friction of each joint comes before friction between two joints, unless the log clearly shows the latter.

Friction that follows the sum of two speeds has fewer parameters than friction of both joints. Where these often move
together, it stands for them, and the friction that every joint has would then be on neither.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cdia_pin.changes.run_to_run import is_friction_of_joint
from cdia_pin.discovery.trust import Repeat
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import (
    AsymmetricFriction,
    CoulombFriction,
    CoupledFriction,
    Effect,
    Term,
    ViscousFriction,
)
from cdia_pin.regression.gauss_newton import fitted_together
from cdia_pin.selection.problem import WhitenedProblem

PLAIN = (CoulombFriction, ViscousFriction)


def with_plain_friction(problem: WhitenedProblem, model: Dynamics, given: Dynamics) -> Dynamics:
    """Return a model in which joints have friction of their own rather than friction between two of them.

    Friction between two joints stays if both have friction of their own, or if it is visible beside that.

    Args:
        problem: The logs and their noise.
        model: The fitted model.
        given: The model before the discovery; its terms stay as they are.
    """
    asked = problem.problem.settings.effects
    if asked is not None and not {kind.name for kind in PLAIN} <= set(asked):
        return model
    known = {t.label for t in given.terms}
    crowded = Repeat(problem.problem.design, model, problem.problem.settings, everyday=True)
    rubbing = {t.effect.scope[0] for t in model.terms if is_friction_of_joint(t.effect)}
    doubtful = [
        t
        for t in model.terms
        if isinstance(t.effect, CoupledFriction)
        and t.label not in known
        and not set(t.effect.scope) <= rubbing  # beside friction of both joints it stands for neither
        and not crowded.is_visible(t)
    ]
    if not doubtful:
        return model
    kept = [t for t in model.terms if t not in doubtful]
    added = _of_each_joint(doubtful, [t.effect for t in kept])
    plain = fitted_together(
        problem.regression, replace(model, terms=(*kept, *(Term(e, (0.0,)) for e in added)))
    )
    repeat = Repeat(problem.problem.design, plain, problem.problem.settings)
    unsure = {t.label for t in plain.terms if t.effect in added and not repeat.survives(t)}
    certain = replace(plain, terms=tuple(t for t in plain.terms if t.label not in unsure))
    return fitted_together(problem.regression, certain) if unsure else plain


def _of_each_joint(terms: Sequence[Term], present: Sequence[Effect]) -> list[Effect]:
    """Return Coulomb and viscous friction of the joints of some terms that have none."""
    joints = dict.fromkeys(j for t in terms for j in t.effect.scope)
    both = {e.joint for e in present if isinstance(e, AsymmetricFriction)}
    labels = {e.label for e in present}
    effects: list[Effect] = [kind(j) for j in joints if j not in both for kind in PLAIN]
    return [e for e in effects if e.label not in labels]
