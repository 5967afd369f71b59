"""The trace: the effects that were found are added again one by one, the most important first, and the error falls."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cdia_pin.discovery.discovery_result import Step
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.identifiability.alternatives import Alternatives
from cdia_pin.identifiability.confusion import Confusion
from cdia_pin.regression.cross_validation import held_out_rms
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.gauss_newton import fitted_together, refit
from cdia_pin.regression.intervals import with_intervals
from cdia_pin.regression.shares import mean_share
from cdia_pin.selection.problem import Problem, WhitenedProblem
from cdia_pin.selection.replacement import refitting

Array = NDArray[np.float64]

ITERATIONS = 2  # iterations of Gauss-Newton [1] for the models between the first and the last


def trace(
    problem: WhitenedProblem, base: Dynamics, found: Dynamics, forced: Collection[str] = ()
) -> tuple[Dynamics, tuple[Step, ...]]:
    """Fit a found model again with intervals, and measure how each of its effects changes the error.

    An effect that raises the held-out error, beside those before it and beside all others, is left out, because the log
    moves too little to identify it. An effect whose only parameter has an interval that contains zero is left out too.

    Args:
        problem: Logs, candidates and noise.
        base: The model at the start of the discovery.
        found: The model at its end.
        forced: Labels of effects that stay in any case.

    Returns:
        The model at its optimum, and the steps from the base to it.
    """
    known = {t.label for t in base.terms}
    while doubtful := _doubtful(with_intervals(*refit(problem.regression, found)), {*known, *forced}):
        found = found.remove(min(doubtful, key=_certainty).label)
    ordered = _ordered(problem, base, found)
    model = Dynamics(base.robot, tuple(t for t in found.terms if t.label in known))
    models, error = [], _mean_error(problem, base)
    for term in ordered:
        trial = fitted_together(problem.regression, model.add(term), ITERATIONS)
        with_it = _mean_error(problem, trial)
        helps = with_it < error * (1 + problem.settings.criterion.most_harm)
        if helps or term.label in forced or not _harms(problem, found, term):
            model, error = trial, with_it
            models.append((term.label, trial))
    final, equations = refit(problem.regression, model)
    final = with_intervals(final, equations)
    if doubtful := _doubtful(final, {*known, *forced}):
        return trace(problem, base, found.remove(min(doubtful, key=_certainty).label), forced)
    beside = problem.evidence(final)
    index = {e.label: i for i, e in enumerate(beside.effects) if e in {t.effect for t in final.terms}}
    alternatives = Alternatives(
        beside, list(index.values()), refitting(problem, final, beside), problem.settings.alternatives
    )
    steps = [step_of(problem, None, base)]
    for k, (label, so_far) in enumerate(models):
        shown = final if k == len(models) - 1 else so_far
        steps.append(step_of(problem, final.find(label), shown, alternatives.of(index[label])))
    return final, tuple(steps)


def _harms(problem: WhitenedProblem, found: Dynamics, term: Term) -> bool:
    """Return True if the held-out error of a model is no larger without one of its terms."""
    without = fitted_together(problem.regression, found.remove(term.label), ITERATIONS)
    return _mean_error(problem, found) >= _mean_error(problem, without)


def _doubtful(model: Dynamics, kept: Collection[str]) -> list[Term]:
    """Return the terms of one parameter whose interval contains zero, except those that stay in any case."""
    return [t for t in model.terms if t.label not in kept and t.effect.size == 1 and _certainty(t) <= 1.0]


def _certainty(term: Term) -> float:
    """Return a term's first parameter over the half width of its interval [1]."""
    assert term.ci95 is not None
    low, high = term.ci95[0]
    return abs(low + high) / max(high - low, 1e-300)


def _ordered(problem: WhitenedProblem, base: Dynamics, found: Dynamics) -> list[Term]:
    """Return the terms that were found; each explains most after those before it."""
    known = {t.label for t in base.terms}
    beside = problem.evidence(found)
    index = {e: i for i, e in enumerate(beside.effects)}
    chosen = [index[t.effect] for t in found.terms if t.label in known]
    pending, out = [t for t in found.terms if t.label not in known], []
    while pending:
        gains = beside.gains(chosen)
        best = max(pending, key=lambda t: gains[index[t.effect]])
        pending.remove(best)
        chosen.append(index[best.effect])
        out.append(best)
    return out


def _mean_error(problem: WhitenedProblem, model: Dynamics) -> float:
    """Return the relative held-out RMS residual, mean over the joints [1]."""
    experiment = problem.experiment
    error = held_out_rms(problem.regression, experiment.predict(model))
    return mean_share(error, rms(experiment.measured, experiment.informative))


def step_of(
    problem: WhitenedProblem,
    term: Term | None,
    model: Dynamics,
    confusions: tuple[Confusion, ...] = (),
) -> Step:
    """Return the errors of a model as a step of the trace.

    Args:
        problem: Logs, candidates and noise.
        term: The term that the step adds; None for the model as given.
        model: The model with all steps up to this one.
        confusions: Other explanations of what the term explains.
    """
    prediction = problem.experiment.predict(model)
    by_blocks = None if term is None else partial(held_out_rms, problem.regression, prediction)
    return Step(term, *errors_of(problem.problem, model, by_blocks), confusions)


def errors_of(logs: Problem, model: Dynamics, by_blocks: Callable[[], Array] | None) -> tuple[Array, Array]:
    """Return the RMS residual of each joint, and that on data that was not fitted [N·m or N], shape (n,) each.

    Args:
        logs: The logs, and those that are only predicted, if any.
        model: The model.
        by_blocks: Returns the RMS residual when each block of time is left out of the fit; None if nothing was fitted.
    """
    fitted = logs.rms(model)
    if logs.held_out is not None:
        return fitted, rms(logs.held_out.predict(model).residual, logs.held_out.informative)
    return fitted, fitted if by_blocks is None else by_blocks()
