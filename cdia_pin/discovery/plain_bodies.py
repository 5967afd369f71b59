"""Rotors and offsets of joints come before a body that predicts no better than they do.

A body has ten parameters and acts on several joints. Where a motion tells little of masses, it follows the rotors of
these joints and a little of whatever else is there. It then names a link that is as it was, another one in each log.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

from cdia_pin.discovery.certain_effects import with_certain
from cdia_pin.discovery.one_by_one import heldout_error
from cdia_pin.discovery.trace import without_doubtful
from cdia_pin.discovery.trust import Repeat
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, RotorInertia, Term, TorqueOffset
from cdia_pin.effects.body import Body
from cdia_pin.effects.refinements import REFINED
from cdia_pin.regression.gauss_newton import fitted_together
from cdia_pin.selection.every_link import has_every_link
from cdia_pin.selection.problem import WhitenedProblem

PARTS = (RotorInertia, TorqueOffset)  # what a body is to a single joint: inertia, and load


def with_plain_bodies(problem: WhitenedProblem, model: Dynamics, given: Dynamics) -> Dynamics:
    """Return a model without the bodies that rotors and offsets of their joints replace, the least certain first.

    They do if blocks of time that were not fitted are predicted better with them.

    Args:
        problem: The logs and their noise.
        model: The fitted model.
        given: The model before the discovery; its terms stay as they are.
    """
    known, asked = {t.label for t in given.terms}, problem.settings.effects
    if asked is not None and not {kind.name for kind in PARTS} <= set(asked):
        return model
    bodies = [t for t in model.terms if isinstance(t.effect, Body) and t.label not in known]
    if not bodies or has_every_link(model):
        return model
    repeat = Repeat(problem.problem.design, model, problem.problem.settings)
    for body in sorted(bodies, key=repeat.certainty):
        others = model.remove(body.label)
        plain = with_certain(problem, others, list(_parts(problem, others, body)))
        if _predicts_as_well(problem, plain, model, known):
            model = plain
    return model


def _predicts_as_well(
    problem: WhitenedProblem, plain: Dynamics, model: Dynamics, known: Collection[str]
) -> bool:
    """Tell whether a plain model has no larger held-out error, also without the effects that may be nothing."""

    def settled(model: Dynamics) -> Dynamics:
        return fitted_together(problem.regression, without_doubtful(problem, model, known))

    return heldout_error(problem, plain) <= heldout_error(problem, model) and (  # most fail here
        heldout_error(problem, settled(plain)) <= heldout_error(problem, settled(model))
    )


def _parts(problem: WhitenedProblem, others: Dynamics, body: Term) -> Iterator[Effect]:
    """Yield the candidates that a body is to each of its joints, unless the other terms have such a one."""
    candidates = {f[0].label: f[0] for f in problem.problem.families}
    for j in body.effect.acts_on(others.robot):
        joint = others.robot.joints[j]
        own = [t.effect for t in others.terms if t.effect.scope == (joint,)]
        for kind in PARTS:
            part = candidates.get(kind(joint).label)
            if part and not any(e.name == kind.name or kind in REFINED.get(type(e), ()) for e in own):
                yield part
