"""Unusual effects that nobody would believe leave a model that predicts as well without them.

A measured arm differs from every model a little, in all joints. A fluid, a steady wrench or a tilt of the base follows
some of that. Such an effect is not certain, but while it is in the model it bends the effects that are there, or takes
their place, as a steady wrench that of a payload. Effects of any kind that make the model predict worse than the given
one are doubted too.
"""

from __future__ import annotations

from collections.abc import Collection
from contextlib import suppress

from cdia_pin.discovery.decision import Repeat
from cdia_pin.discovery.one_by_one import heldout_error, is_no_worse, kept
from cdia_pin.discovery.unusual_effects import unusual_terms
from cdia_pin.dynamics import Dynamics
from cdia_pin.progress import Progress
from cdia_pin.regression.gauss_newton import DIVERGED
from cdia_pin.selection.problem import WhitenedProblem
from cdia_pin.selection.search import Swaps, search


def doubted(problem: WhitenedProblem, found: Dynamics, given: Dynamics) -> set[str]:
    """Return the labels of the unusual effects that were found and are not certain beside all everyday ones.

    Args:
        problem: Logs and settings.
        found: The model that a search has found.
        given: The model before it; its own terms are not doubted.
    """
    unusual = unusual_terms(problem, found, given)
    if not unusual:
        return set()
    crowded = Repeat.of(problem.problem, found).crowded
    return {t.label for t in unusual if not crowded.is_beyond_doubt(t)}


def plain_model(
    problem: WhitenedProblem, found: Dynamics, before: Dynamics, doubt: Collection[str], report: Progress
) -> Dynamics | None:
    """Return a model without doubted effects that predicts as well as the one with them; None if there is none.

    The model before the search may be one. What was found beside a doubted effect may be there for that alone: so where
    a search from the others leads to no such model, another one begins at the model before.

    Args:
        problem: Logs, candidates and noise.
        found: The model with the doubted effects.
        before: The model before the search.
        doubt: Their labels.
        report: Called with what changed and the share done [1].
    """
    rest = problem.without(doubt)
    plain = before.without(doubt)
    if plain is before and predicts_as_well(problem, before, found):
        return before
    for start in (found.without(doubt), plain):
        with suppress(*DIVERGED):  # such a search leads nowhere
            then = search(rest, start, Swaps(), report)
            if predicts_as_well(problem, then, found):
                return then
    return None


def predicts_as_well(problem: WhitenedProblem, plain: Dynamics, found: Dynamics) -> bool:
    """Tell whether a model without some effects has the same error on blocks of time that were not fitted.

    Args:
        problem: The logs.
        plain: The model without them, at its optimum.
        found: The model with them.
    """
    worth = problem.settings.confidence.worth_of_doubted
    return heldout_error(problem, plain) <= worth * heldout_error(problem, found)


def harmful(problem: WhitenedProblem, found: Dynamics, given: Dynamics) -> set[str]:
    """Return the labels of the effects that make a found model predict worse than the model before it, fitted again.

    The log moves too little to tell what each of them is of: together they fit it, and say nothing of other motions.

    Args:
        problem: Logs and settings.
        found: The model that a search has found.
        given: The model before it.
    """
    if is_no_worse(problem, heldout_error(problem, found), heldout_error(problem, given)):
        return set()
    try:
        stay = {m.label for m in kept(problem, given, found)}
    except DIVERGED:  # a part of the model that no search has fitted
        return set()
    return {t.label for t in found.terms} - {t.label for t in given.terms} - stay
