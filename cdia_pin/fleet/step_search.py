r"""The search for a step in a course: a robust regression with and without it.

A value of log i is explained by regressors, such as a constant and the temperature, and by a step at log k:

.. math::

    y_i = x_i^T b + \delta\, [i \ge k] + e_i

Both fits share the regressors, so the temperature cannot take the step, nor the step the temperature, beyond what the
data tell. `robust_fit` says what e is. The size of the step need not be known; a CUSUM that knows it is at most a few
logs faster [Lorden1971].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.fleet.alarm_limit import FEWEST_AFTER
from cdia_pin.fleet.robust_fit import ROUNDS, fit_once, robust_fit, usual_deviations

Array = NDArray[np.float64]

SMALLEST = 1e-300  # probability [1] that a double still holds
FEWEST_BEFORE = 5  # logs before a change [1], so that there is something to compare with
IMITATED = 1e-6  # share of a step [1] that the regressors must leave, so that it says something


@dataclass(frozen=True)
class CourseStep:
    """The most likely step of a course.

    Attributes:
        at: Index of the first log after it.
        size: δ, in the unit of the parameter.
        deviation: Its standard deviation, in the unit of the parameter.
        z: Its size over its standard deviation, as a standard normal value of equal probability [1].
    """

    at: int
    size: float
    deviation: float
    z: float


def find_step(values: Array, deviations: Array, regressors: Array) -> CourseStep | None:
    """Return the most likely step of a course; None if it has too few logs.

    Args:
        values: The parameter in each log, shape (N,).
        deviations: Standard deviation of each value as its log states it, shape (N,).
        regressors: What explains the values besides, a constant first, shape (N, p).
    """
    count, p = regressors.shape
    freedom = count - p - 1
    if count < FEWEST_BEFORE + FEWEST_AFTER or freedom < FEWEST_BEFORE:
        return None
    stated = usual_deviations(deviations)
    fit = robust_fit(values, stated, regressors)  # without a step, so that one bad log does not pass for one
    at = 0
    for _ in range(ROUNDS + 1):
        at = _likeliest(fit.clipped, fit.variance, regressors)
        fit = fit_once(values, stated, _with_step(regressors, at), fit.clipped, fit.variance)
    size, deviation = float(fit.coefficients[-1]), float(fit.deviations[-1])
    return CourseStep(at, size, deviation, _normal(size / deviation, freedom))


def _with_step(regressors: Array, at: int) -> Array:
    step = np.zeros(len(regressors))
    step[at:] = 1.0
    return np.column_stack([regressors, step])


def _likeliest(values: Array, variance: Array, regressors: Array) -> int:
    """Return the index of the first log after the step that explains most."""
    w = 1.0 / np.sqrt(variance)
    basis, _ = np.linalg.qr(regressors * w[:, None])
    left = w * values
    left = left - basis @ (basis.T @ left)
    gained = _sums(w * left)
    common = _sums(w[:, None] * basis)
    room = np.maximum(_sums(w**2) - np.sum(common**2, axis=1), 1e-300)
    explained = gained**2 / room
    explained[room < IMITATED * np.sum(w**2)] = 0.0
    allowed = slice(FEWEST_BEFORE, len(values) - FEWEST_AFTER + 1)
    return FEWEST_BEFORE + int(np.argmax(explained[allowed]))


def _sums(x: Array) -> Array:
    """Return the sum of each row and all later ones."""
    return np.asarray(np.cumsum(x[::-1], axis=0)[::-1])


def _normal(t: float, freedom: int) -> float:
    """Return the standard normal value that is as improbable as a value of Student's distribution."""
    from scipy.special import ndtri, stdtr

    return float(np.copysign(-ndtri(max(stdtr(freedom, -abs(t)), SMALLEST)), t))
