"""Explanations that are not linear, fitted at their own optimum: normal equations know them to first order only."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Term
from cdia_pin.regression.fitting import MOST_ITERATIONS, Whitened, refit
from cdia_pin.selection.evidence import Evidence, Fit
from cdia_pin.selection.problem import Problem

NEARLY = (
    0.9  # share of what an effect explains that another must explain to first order to be fitted as it is
)

Refit = Callable[[Sequence[int], int], Fit]  # indices of a set and of one more, fitted at their own optimum


def refitting(
    problem: Problem,
    model: Dynamics,
    whitened: Whitened,
    evidence: Evidence,
    iterations: int = MOST_ITERATIONS,
) -> Refit:
    """Return how another effect is fitted in the place of some of a model's, beside all the rest of it.

    Args:
        problem: Logs and candidates.
        model: A fitted model.
        whitened: Noise and blocks.
        evidence: Normal equations of its effects and all candidates, whose indices and prices the fits have.
        iterations: Most of a refit.
    """
    experiment, columns = problem.experiment, problem.columns

    def refitted(rest: Sequence[int], other: int) -> Fit:
        chosen = tuple(sorted((*rest, other)))
        present = {t.effect: t for t in model.terms}
        effects = [evidence.effects[c] for c in chosen]
        terms = tuple(present[e] if e in present else Term(e, (0.0,) * e.size) for e in effects)
        _, at_optimum = refit(experiment, columns, Dynamics(model.robot, terms), whitened, iterations)
        fit = at_optimum.fit(range(len(effects)), bodies=True)
        cost = fit.chi2 + float(evidence.price[list(chosen)].sum())
        return Fit(chosen, fit.theta, fit.chi2, cost, fit.possible, fit.physical)

    return refitted


def promising(
    evidence: Evidence, rest: Sequence[int], enough: Callable[[Effect], float]
) -> Iterator[tuple[int, float]]:
    """Yield the candidates that explain enough beside a set, to first order, the best first, of each its best shape.

    Each comes with what it would lower chi2 by [1].

    Args:
        evidence: Normal equations of all candidates.
        rest: The set.
        enough: By how much an effect must lower chi2 [1].
    """
    gains = evidence.gains(rest)
    taken = {evidence.effects[c].label for c in rest}
    for c in np.argsort(gains)[::-1]:
        effect = evidence.effects[c]
        if effect.label not in taken and gains[c] >= enough(effect):
            taken.add(effect.label)
            yield int(c), float(gains[c])
