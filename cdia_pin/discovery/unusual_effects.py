"""Unusual effects beside everyday ones: what a search begins with, and where it must begin again.

Everyday effects are searched first, because unusual ones follow a little of whatever else is wrong on a measured arm.
But everyday effects together may also stand for an unusual one that is there.
"""

from __future__ import annotations

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.selection.problem import WhitenedProblem

# On six measured arms the share is at most 0.80, and at least 1.00 for effects put into simulated arms: all values
# between decide alike.
AS_MUCH = 0.95  # [1], share of what everyday effects explain that an unusual one alone explains if it is their rival


def unusual_terms(problem: WhitenedProblem, found: Dynamics, given: Dynamics) -> list[Term]:
    """Return the terms of unusual effects that were found.

    Args:
        problem: Logs and settings.
        found: The model that a search has found.
        given: The model before it.
    """
    known = {t.label for t in given.terms}
    return [t for t in found.terms if t.label not in known and problem.settings.is_unusual(t.effect)]


def everyday(problem: WhitenedProblem, model: Dynamics) -> WhitenedProblem:
    """Return a problem without the unusual candidates that a model has not.

    Args:
        problem: Logs, candidates and noise.
        model: The model.
    """
    known = {t.label for t in model.terms}
    kinds = [f[0] for f in problem.problem.families]
    return problem.without(e.label for e in kinds if problem.settings.is_unusual(e) and e.label not in known)


def has_unusual_rival(problem: WhitenedProblem, given: Dynamics, found: Dynamics) -> bool:
    """Tell whether one unusual effect alone explains as much as all everyday effects that were found.

    Args:
        problem: Logs, candidates and noise.
        given: The model before the search.
        found: The model that the search has found.
    """
    evidence, present = problem.evidence(given), range(len(given.terms))
    gains = zip(evidence.effects, evidence.gains(present), strict=True)
    most = max((gain for effect, gain in gains if problem.settings.is_unusual(effect)), default=0.0)
    return bool(most >= AS_MUCH * (evidence.free_chi2(present) - problem.regression.chi2(found)))
