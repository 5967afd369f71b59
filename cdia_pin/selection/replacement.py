"""Replacement: nonlinear effects are fitted at their own optimum in the place of others."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Term
from cdia_pin.regression.bounded_fit import bounded_fit
from cdia_pin.regression.gauss_newton import DIVERGED, fitted_together
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.selection.evidence import Evidence, SetFit
from cdia_pin.selection.problem import WhitenedProblem

NEARBY = 3  # iterations of Gauss-Newton [1] after the one that the evidence holds; they settle which set costs less

Refit = Callable[
    [Sequence[int], int], SetFit
]  # indices of a set and of one more, fitted at their own optimum


def refitting(
    problem: WhitenedProblem, model: Dynamics, evidence: Evidence, iterations: int = NEARBY
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
        start = evidence.fit(chosen, bodies=True).theta
        first = ParameterBlocks.of(effects).split(start)
        try:
            terms = tuple(
                present[e].with_theta(part) if e in present else Term(e, tuple(part))
                for e, part in zip(effects, first, strict=True)
            )
            then = fitted_together(problem.regression, Dynamics(model.robot, terms), iterations)
            equations = problem.regression.normal_equations(then, effects)
            fit = bounded_fit(equations, range(len(effects)), bodies=True)
        except DIVERGED:
            return SetFit(chosen, start, np.inf, np.inf, False, False)
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
    taken = {evidence.labels[c] for c in rest}
    for c in np.argsort(gains)[::-1]:
        if evidence.labels[c] not in taken and gains[c] >= enough(evidence.effects[c]):
            taken.add(evidence.labels[c])
            yield int(c), float(gains[c])
