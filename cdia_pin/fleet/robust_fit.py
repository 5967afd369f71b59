r"""A robust regression of the values of a course.

.. math::

    y_i = x_i^T b + e_i, \qquad \mathrm{var}(e_i) = s_i^2 + \sigma^2

s is what log i itself says of its uncertainty, at least that of a usual log, and σ is what differs from log to log
besides. Values far from the fit count as if they were :math:`c` standard deviations away [Huber1981].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Counts = NDArray[np.int_]

CLIP = 2.5  # c, standard deviations [1] beyond which a value counts no more; a normal one is there in 1 % of the cases
CLIPPED_VARIANCE = 0.9556  # of a standard normal value that is clipped there [1]
ROUNDS = 3  # rounds [1] of weights and clipped values, which depend on each other
LEAST = 1e-6  # variance over the largest one that is possible [1]
LARGEST_MEMORY = (
    0.8  # autocorrelation of neighbours [1]; above it a course wanders, and a step is as likely as none
)
RIDGE = 1e-10  # added to a unit diagonal [1], so that columns that repeat each other can be solved
TRIED = 40  # variances that are tried [1]; between them it is interpolated, to a hundredth
TRIALS = np.geomspace(LEAST, 1.0, TRIED)
HALVINGS = (TRIED - 2).bit_length()  # of the trials, until two neighbours are left


@dataclass(frozen=True)
class RobustFit:
    """A fit of columns to the values of a course, or one for each of several courses, in leading dimensions.

    Attributes:
        fitted: The fit, shape (…, N).
        coefficients: b, one for each column, shape (…, p).
        deviations: Their standard deviations, shape (…, p).
        clipped: The values, no further from the fit than counts, shape (…, N).
        variance: Variance of each value, shape (…, N).
    """

    fitted: Array
    coefficients: Array
    deviations: Array
    clipped: Array
    variance: Array

    @property
    def spread(self) -> float:
        """Standard deviation of the value of a usual log, of one course."""
        return float(np.sqrt(np.median(self.variance)))


def robust_fit(values: Array, stated: Array, columns: Array) -> RobustFit:
    """Fit columns to the values of a course.

    Args:
        values: The parameter in each log, shape (…, N).
        stated: Standard deviation of each value as its log states it, from `usual_deviations`, shape (…, N). A log with
            an infinite one is not there; its value and its columns must be zero.
        columns: What explains the values, shape (…, N, p).
    """
    fit = fit_once(values, stated, columns, values, stated**2 + 1e-300)
    for _ in range(ROUNDS):
        fit = fit_once(values, stated, columns, fit.clipped, fit.variance)
    return fit


def fit_once(values: Array, stated: Array, columns: Array, clipped: Array, variance: Array) -> RobustFit:
    """Return one round of a robust fit.

    Args:
        values: The parameter in each log, shape (…, N).
        stated: Standard deviation of each value as its log states it, as `robust_fit` takes it, shape (…, N).
        columns: What explains the values, shape (…, N, p).
        clipped: The values as they count in this round, shape (…, N).
        variance: Their variance in this round, shape (…, N).
    """
    w = 1.0 / np.sqrt(variance)
    scaled = columns * w[..., None]
    norms = np.sqrt(np.sum(scaled**2, axis=-2)) + 1e-300
    scaled /= norms[..., None, :]
    turned = np.swapaxes(scaled, -1, -2)
    inverse = np.linalg.solve(turned @ scaled + RIDGE * np.eye(scaled.shape[-1]), turned) / norms[..., None]
    b = (inverse @ (w * clipped)[..., None])[..., 0]
    fitted = (columns @ b[..., None])[..., 0]
    count, p = np.isfinite(stated).sum(axis=-1), columns.shape[-1]
    after = _variance(values - fitted, stated, count, np.maximum(count - p, 1) / count)
    deviation = np.sqrt(after)
    reach = CLIP * deviation
    left = np.clip(values - fitted, -reach, reach)
    inflation = _inflation(left / deviation, count, p)
    deviations = np.sqrt(np.sum(inverse**2, axis=-1) * inflation[..., None])
    return RobustFit(fitted, b, deviations, fitted + left, after)


def usual_deviations(stated: Array) -> Array:
    """Return the standard deviations that logs state, none below the usual one, shape (N,).

    A dozen blocks do not tell a standard deviation well, so no log counts for more than a usual one.

    Args:
        stated: As the logs state them, shape (N,).
    """
    return np.maximum(stated, np.median(stated))


def _variance(left: Array, deviations: Array, count: Counts, share: Array) -> Array:
    """Return the variance of each value, so that what is left has it, shape (…, N).

    Args:
        left: What the fit leaves, shape (…, N).
        deviations: What the logs state, shape (…, N).
        count: Number of logs, shape (…).
        share: Degrees of freedom over the number of logs [1], shape (…).
    """
    squares, stated = left**2, deviations**2 + 1e-300
    wanted, most = CLIPPED_VARIANCE * share, CLIP**2

    def size(variance: Array) -> Array:
        return np.asarray(np.minimum(squares / variance, most).sum(axis=-1) / count)

    more = size(stated) > wanted  # than the logs state; else they scatter less
    largest = np.where(more, squares.max(axis=-1) / wanted, 1.0)

    def trial(k: Counts) -> Array:
        tried = (TRIALS[k] * largest)[..., None]
        return np.where(more[..., None], stated + tried, stated * tried)

    # The size falls with the variance: halving finds the two trials between which it is the wanted one.
    low, high = np.zeros(more.shape, int), np.full(more.shape, TRIED - 1)
    for _ in range(HALVINGS):
        middle = (low + high) // 2
        above = size(trial(middle)) >= wanted
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    one, other = size(trial(low)), size(trial(high))
    part = np.clip((one - wanted) / np.maximum(one - other, 1e-300), 0.0, 1.0)
    found = (largest * TRIALS[low] * (TRIALS[high] / TRIALS[low]) ** part)[..., None]
    return np.asarray(np.where(more[..., None], stated + found, stated * found))


def _inflation(scaled: Array, count: Counts, p: int) -> Array:
    """Return by how much values that follow their neighbours widen a variance [1], shape (…).

    What p columns leave of noise without memory has an autocorrelation of -p/N: it is added again. What chance gives
    besides is not taken off, since noise with memory would then give false alarms (`python -m benchmarks.fleet.tails`).

    Args:
        scaled: What the fit leaves over its standard deviation [1], shape (…, N).
        count: Number of logs, shape (…).
        p: Number of columns that were fitted.
    """
    power = np.sum(scaled**2, axis=-1)
    seen = np.sum(scaled[..., 1:] * scaled[..., :-1], axis=-1) / np.maximum(power, 1e-300)
    rho = np.clip(seen + p / count, 0.0, LARGEST_MEMORY)
    return np.asarray((1 + rho) / (1 - rho))
