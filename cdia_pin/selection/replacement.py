"""Replacement: effects that are not linear, fitted at their own optimum in the place of others."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Term
from cdia_pin.regression.bounded_fit import bounded_fit
from cdia_pin.regression.gauss_newton import MOST_ITERATIONS, refit
from cdia_pin.selection.evidence import Evidence, SetFit
from cdia_pin.selection.problem import WhitenedProblem

Refit = Callable[
    [Sequence[int], int], SetFit
]  # indices of a set and of one more, fitted at their own optimum


def refitting(
    problem: WhitenedProblem, model: Dynamics, evidence: Evidence, iterations: int = MOST_ITERATIONS
) -> Refit:
    """Return how another effect is fitted in the place of some of a model's, beside all the rest of it.

    Normal equations describe an effect that is not linear to first order only.

    Args:
        problem: Logs, candidates and noise.
        model: A fitted model.
        evidence: Evidence for its effects and all candidates, whose indices and penalties the fits have.
        iterations: Most of a refit.
    """

    def refitted(rest: Sequence[int], other: int) -> SetFit:
        chosen = tuple(sorted((*rest, other)))
        present = {t.effect: t for t in model.terms}
        effects = [evidence.effects[c] for c in chosen]
        terms = tuple(present[e] if e in present else Term(e, (0.0,) * e.size) for e in effects)
        _, equations = refit(problem.regression, Dynamics(model.robot, terms), iterations)
        fit = bounded_fit(equations, range(len(effects)), bodies=True)
        cost = fit.chi2 + evidence.penalty_of(chosen)
        return SetFit(chosen, fit.theta, fit.chi2, cost, fit.possible, fit.physical)

    return refitted


def promising(
    evidence: Evidence, rest: Sequence[int], enough: Callable[[Effect], float]
) -> Iterator[tuple[int, float]]:
    """Yield the candidates that explain enough beside a set, to first order, the best first, of each its best shape.

    Each comes with what it would lower chi2 by [1].

    Args:
        evidence: Evidence for all candidates.
        rest: Indices of the set.
        enough: By how much an effect must lower chi2 [1].
    """
    gains = evidence.gains(rest)
    taken = {evidence.effects[c].label for c in rest}
    for c in np.argsort(gains)[::-1]:
        effect = evidence.effects[c]
        if effect.label not in taken and gains[c] >= enough(effect):
            taken.add(effect.label)
            yield int(c), float(gains[c])
