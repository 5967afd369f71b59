r"""The search for a step in a course: a robust regression with and without it.

A value of log i is explained by regressors, such as a constant and the temperature, and by a step at log k:

.. math::

    y_i = x_i^T b + \delta\, [i \ge k] + e_i

Both fits share the regressors, so the temperature cannot take the step, nor the step the temperature, beyond what the
data tell. `robust_fit` says what e is. The size of the step need not be known; a CUSUM that knows it is at most a few
logs faster [Lorden1971].

The shorter side of a step says how sure it is. A mean of few logs has longer tails than a normal value, since their
motions differ. So the step over its standard deviation is taken as a value of Student's distribution, whose degrees of
freedom grow with the logs on that side, as those of two means with unlike variances do [Welch1947].
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.fleet.alarm_limit import FEWEST_AFTER
from cdia_pin.fleet.robust_fit import ROUNDS, Counts, fit_once, robust_fit, usual_deviations

Array = NDArray[np.float64]

SMALLEST = 1e-300  # probability [1] that a double still holds
FEWEST_BEFORE = 5  # logs before a change [1], so that there is something to compare with
# Of 20 false alarms that are stated, 9 to 17 come in noise of four kinds, long tails among them; with 4 it is 5 to 14,
# with 6 it is 10 to 24, and without it 13 to 47 (`python -m benchmarks.fleet.tails --freedom 4`).
FREEDOM_OF_A_LOG = 5  # degrees of freedom [1] that each log on the shorter side of a step adds
IMITATED = 1e-6  # share of a step [1] that the regressors must leave, so that it says something

AT_ONCE = 16_384  # values [1] that are fitted at once; more of them leave the processor's cache


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
    return next(iter(find_steps(values, deviations, regressors, [len(values)]).values()), None)


def find_steps(
    values: Array, deviations: Array, regressors: Array, counts: Sequence[int]
) -> dict[int, CourseStep]:
    """Return the most likely step among the first logs of a course, by their number.

    Args:
        values: The parameter in each log, shape (N,).
        deviations: Standard deviation of each value as its log states it, shape (N,).
        regressors: What explains the values besides, a constant first, shape (N, p).
        counts: Numbers of first logs, ascending; those that are too few for a step are left out.
    """
    p = regressors.shape[1]
    fewest = max(FEWEST_BEFORE + FEWEST_AFTER, FEWEST_BEFORE + p + 1)
    enough = [n for n in counts if n >= fewest]
    at_once = max(1, AT_ONCE // max(len(values), 1))
    out: dict[int, CourseStep] = {}
    for k in range(0, len(enough), at_once):
        some = enough[k : k + at_once]
        out |= zip(some, _steps_of(values, deviations, regressors, np.array(some)), strict=True)
    return out


def deviations_to_pass(limit: float, logs: int) -> float:
    """Return how many of its standard deviations a step must have to pass a limit, in a long course [1].

    Args:
        limit: Limit of :math:`|z|` [1].
        logs: Logs after the step [1].
    """
    from scipy.special import ndtr, stdtrit

    return float(-stdtrit(FREEDOM_OF_A_LOG * logs, max(ndtr(-limit), SMALLEST)))


def _steps_of(values: Array, deviations: Array, regressors: Array, counts: Counts) -> Iterator[CourseStep]:
    """Yield the most likely step among the first logs, for each of several numbers of logs that are enough.

    All are fitted at once: row l of an array is the course as it was after so many logs.
    """
    most, p = int(counts[-1]), regressors.shape[1]
    there = np.arange(most) < counts[:, None]
    seen = np.where(there, values[:most], 0.0)
    stated = np.full(there.shape, np.inf)
    for row, n in zip(stated, counts, strict=True):
        row[:n] = usual_deviations(deviations[:n])
    columns = np.zeros((*there.shape, p + 1))
    columns[..., :p] = np.where(there[..., None], regressors[:most], 0.0)
    plain = columns[..., :p]
    fit = robust_fit(seen, stated, plain)  # without a step, so that one bad log does not pass for one
    at = np.zeros(len(counts), int)
    for _ in range(ROUNDS + 1):
        at = _likeliest(fit.clipped, fit.variance, plain, counts)
        columns[..., p] = there & (np.arange(most) >= at[:, None])
        fit = fit_once(seen, stated, columns, fit.clipped, fit.variance)
    for first, size, deviation, n in zip(
        at, fit.coefficients[:, -1], fit.deviations[:, -1], counts, strict=True
    ):
        freedom = min(int(n) - p - 1, FREEDOM_OF_A_LOG * int(min(first, n - first)))
        yield CourseStep(int(first), float(size), float(deviation), _normal(float(size / deviation), freedom))


def _likeliest(values: Array, variance: Array, regressors: Array, counts: Counts) -> Counts:
    """Return the index of the first log after the step that explains most, shape (L,).

    Args:
        values: The values, zero behind the last log, shape (L, N).
        variance: Their variance, infinite behind the last log, shape (L, N).
        regressors: What explains them besides, shape (L, N, p).
        counts: Number of logs, shape (L,).
    """
    w = 1.0 / np.sqrt(variance)
    basis, _ = np.linalg.qr(regressors * w[..., None])
    left = w * values
    left = left - (basis @ (np.swapaxes(basis, -1, -2) @ left[..., None]))[..., 0]
    gained = _sums(w * left)
    common = np.stack([_sums(w * basis[..., k]) for k in range(basis.shape[-1])], axis=-1)
    room = np.maximum(_sums(w**2) - np.sum(common**2, axis=-1), 1e-300)
    explained = gained**2 / room
    explained[room < IMITATED * np.sum(w**2, axis=-1)[:, None]] = 0.0
    first = np.arange(values.shape[1])
    allowed = (first >= FEWEST_BEFORE) & (first <= (counts - FEWEST_AFTER)[:, None])
    return np.asarray(np.argmax(np.where(allowed, explained, -1.0), axis=1))


def _sums(x: Array) -> Array:
    """Return the sum of each value and all later ones, shape (…, N)."""
    return np.asarray(np.cumsum(x[..., ::-1], axis=-1)[..., ::-1])


def _normal(t: float, freedom: int) -> float:
    """Return the standard normal value that is as improbable as a value of Student's distribution."""
    from scipy.special import ndtri, stdtr

    return float(np.copysign(-ndtri(max(stdtr(freedom, -abs(t)), SMALLEST)), t))
