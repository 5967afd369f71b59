"""The trace: the effects that were found are added again one by one, the most important first, and the error falls."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cdia_pin.discovery.discovery_result import Step
from cdia_pin.discovery.one_by_one import kept
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.regression.cross_validation import held_out_rms
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.gauss_newton import refit
from cdia_pin.regression.intervals import with_intervals
from cdia_pin.selection.idle_drives import is_idle
from cdia_pin.selection.problem import Problem, WhitenedProblem
from cdia_pin.selection.shapes import with_shapes_fitted

Array = NDArray[np.float64]


def trace(
    problem: WhitenedProblem, base: Dynamics, found: Dynamics, forced: Collection[str] = ()
) -> tuple[Dynamics, tuple[Step, ...]]:
    """Fit a found model again with intervals, and measure how each of its effects changes the error.

    An effect that raises the held-out error is left out, because the log moves too little to identify it: see `kept`.
    So are an effect whose only parameter has an interval that contains zero, and a drive that could not have moved the
    arm.

    Args:
        problem: Logs, candidates and noise.
        base: The model at the start of the discovery.
        found: The model at its end.
        forced: Labels of effects that stay in any case.

    Returns:
        The model at its optimum, and the steps from the base to it.
    """
    known = {t.label for t in base.terms}
    found = without_doubtful(problem, found, {*known, *forced})
    models = kept(problem, base, found, forced)
    shaped = [t.label for t in models[-1].model.terms if t.effect.shape and t.label not in known]
    final = with_shapes_fitted(problem.regression, models[-1].model, shaped)
    final, equations = refit(problem.regression, final)
    final = with_intervals(final, equations)
    if doubtful := _doubtful(final, {*known, *forced}):
        return trace(problem, base, found.remove(doubtful[0].label), forced)
    steps = [step_of(problem, None, base)]
    for m in models[1:]:
        shown = final if m is models[-1] else m.model
        steps.append(step_of(problem, final.find(m.label), shown))
    return final, tuple(steps)


def without_doubtful(problem: WhitenedProblem, found: Dynamics, kept: Collection[str]) -> Dynamics:
    """Return a found model without effects that may be nothing, and without drives that could not have moved the arm.

    An effect may be nothing if its only parameter has an interval that contains zero.

    Args:
        problem: Logs, candidates and noise.
        found: The model, at its optimum or near it.
        kept: Labels of effects that stay in any case.
    """
    while doubtful := _doubtful(with_intervals(*refit(problem.regression, found)), kept):
        found = found.remove(doubtful[0].label)
    return found


def _doubtful(model: Dynamics, kept: Collection[str]) -> list[Term]:
    """Return the idle drives and the effects that may be nothing, the least certain first, except those that stay."""
    found = [t for t in model.terms if t.label not in kept]
    nothing = [t for t in found if t.effect.size == 1 and _certainty(t) <= 1.0]
    return [*filter(is_idle, found), *sorted(nothing, key=_certainty)]


def _certainty(term: Term) -> float:
    """Return a term's first parameter over the half width of its interval [1]."""
    assert term.ci95 is not None
    low, high = term.ci95[0]
    return abs(low + high) / max(high - low, 1e-300)


def step_of(problem: WhitenedProblem, term: Term | None, model: Dynamics) -> Step:
    """Return the errors of a model as a step of the trace.

    Args:
        problem: Logs, candidates and noise.
        term: The term that the step adds; None for the model as given.
        model: The model with all steps up to this one.
    """
    prediction = problem.experiment.predict(model)
    by_blocks = None if term is None else partial(held_out_rms, problem.regression, prediction)
    return Step(term, *errors_of(problem.problem, model, by_blocks))


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
