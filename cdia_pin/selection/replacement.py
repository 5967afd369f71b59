"""Replacement: nonlinear effects are fitted at their own optimum in the place of others."""

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
    """Return a function that fits a candidate at its own optimum together with some of a model's effects.

    Normal equations describe a nonlinear effect to first order only.

    Args:
        problem: Logs, candidates and noise.
        model: A fitted model.
        evidence: Evidence for its effects and all candidates; indices and penalties are those of the evidence.
        iterations: Largest number of iterations of a refit [1].
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
    """Yield candidates that explain enough when they are added to a set, to first order, each in its best shape.

    The best comes first. Each comes with its gain: by how much it would lower chi2 [1].

    Args:
        evidence: Evidence for all candidates.
        rest: Indices of the set.
        enough: Returns the least gain of an effect [1].
    """
    gains = evidence.gains(rest)
    taken = {evidence.effects[c].label for c in rest}
    for c in np.argsort(gains)[::-1]:
        effect = evidence.effects[c]
        if effect.label not in taken and gains[c] >= enough(effect):
            taken.add(effect.label)
            yield int(c), float(gains[c])
