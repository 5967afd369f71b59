"""Effects that are added to a model together, of which the certain ones stay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cdia_pin.discovery.decision import Repeat
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Term
from cdia_pin.regression.gauss_newton import fitted_together
from cdia_pin.selection.problem import WhitenedProblem


def with_certain(
    problem: WhitenedProblem,
    model: Dynamics,
    added: Sequence[Effect],
    groups: Sequence[Sequence[Effect]] = (),
) -> Dynamics:
    """Return a fitted model with those of some effects that are certain beside all others.

    Args:
        problem: The logs and their noise.
        model: A model without these effects; its own terms stay.
        added: The effects.
        groups: Effects of which one must be there: of a group of which none is certain, the first stays.
    """
    whole = replace(model, terms=(*model.terms, *(Term(e, (0.0,) * e.size) for e in added)))
    whole = fitted_together(problem.regression, whole)
    repeat = Repeat.of(problem.problem, whole)
    certain = {t.label for t in whole.terms if t.effect not in added or repeat.survives(t)}
    certain |= {group[0].label for group in groups if not certain & {e.label for e in group}}
    terms = tuple(t for t in whole.terms if t.label in certain)
    return (
        fitted_together(problem.regression, replace(whole, terms=terms))
        if len(terms) < len(whole.terms)
        else whole
    )
