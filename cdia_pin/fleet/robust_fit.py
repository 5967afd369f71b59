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

CLIP = 2.5  # c, standard deviations [1] beyond which a value counts no more; a normal one is there in 1 % of the cases
CLIPPED_VARIANCE = 0.9556  # of a standard normal value that is clipped there [1]
ROUNDS = 3  # rounds [1] of weights and clipped values, which depend on each other
LEAST = 1e-6  # variance over the largest one that is possible [1]
RIDGE = 1e-10  # added to a unit diagonal [1], so that columns that repeat each other can be solved
TRIED = 40  # variances that are tried [1]; between them it is interpolated, to a hundredth


@dataclass(frozen=True)
class RobustFit:
    """A fit of columns to the values of a course.

    Attributes:
        fitted: The fit, shape (N,).
        coefficients: b, one for each column, shape (p,).
        deviations: Their standard deviations, shape (p,).
        clipped: The values, no further from the fit than counts, shape (N,).
        variance: Variance of each value, shape (N,).
    """

    fitted: Array
    coefficients: Array
    deviations: Array
    clipped: Array
    variance: Array

    @property
    def spread(self) -> float:
        """Standard deviation of the value of a usual log."""
        return float(np.sqrt(np.median(self.variance)))


def robust_fit(values: Array, stated: Array, columns: Array) -> RobustFit:
    """Fit columns to the values of a course.

    Args:
        values: The parameter in each log, shape (N,).
        stated: Standard deviation of each value as its log states it, from `usual_deviations`, shape (N,).
        columns: What explains the values, shape (N, p).
    """
    fit = fit_once(values, stated, columns, values, stated**2 + 1e-300)
    for _ in range(ROUNDS):
        fit = fit_once(values, stated, columns, fit.clipped, fit.variance)
    return fit


def fit_once(values: Array, stated: Array, columns: Array, clipped: Array, variance: Array) -> RobustFit:
    """Return one round of a robust fit.

    Args:
        values: The parameter in each log, shape (N,).
        stated: Standard deviation of each value as its log states it, shape (N,).
        columns: What explains the values, shape (N, p).
        clipped: The values as they count in this round, shape (N,).
        variance: Their variance in this round, shape (N,).
    """
    w = 1.0 / np.sqrt(variance)
    scaled = columns * w[:, None]
    scaled /= (norms := np.sqrt(np.sum(scaled**2, axis=0)) + 1e-300)
    inverse = np.linalg.solve(scaled.T @ scaled + RIDGE * np.eye(scaled.shape[1]), scaled.T) / norms[:, None]
    b = inverse @ (w * clipped)
    fitted = columns @ b
    count, p = columns.shape
    after = _variance(values - fitted, stated, max(count - p, 1) / count)
    reach = CLIP * np.sqrt(after)
    left = np.clip(values - fitted, -reach, reach)
    inflation = _inflation(left / np.sqrt(after))
    deviations = np.sqrt(np.sum(inverse**2, axis=1) * inflation)
    return RobustFit(fitted, b, deviations, fitted + left, after)


def usual_deviations(stated: Array) -> Array:
    """Return the standard deviations that logs state, none below the usual one, shape (N,).

    A dozen blocks do not tell a standard deviation well, so no log counts for more than a usual one.

    Args:
        stated: As the logs state them, shape (N,).
    """
    return np.maximum(stated, np.median(stated))


def _variance(left: Array, deviations: Array, share: float) -> Array:
    """Return the variance of each value, so that what is left has it, shape (N,).

    Args:
        left: What the fit leaves, shape (N,).
        deviations: What the logs state, shape (N,).
        share: Degrees of freedom over the number of logs [1].
    """
    squares, stated = left**2, deviations**2 + 1e-300
    wanted, most = CLIPPED_VARIANCE * share, CLIP**2
    more = np.minimum(squares / stated, most).mean() > wanted  # than the logs state; else they scatter less
    tried = np.geomspace(LEAST, 1.0, TRIED) * (float(squares.max()) / wanted if more else 1.0)
    trials = stated + tried[:, None] if more else stated * tried[:, None]
    size = np.minimum(squares / trials, most).mean(axis=1)  # falls with the variance
    found = float(np.exp(np.interp(-wanted, -size, np.log(tried))))
    return np.asarray(stated + found if more else stated * found)


def _inflation(scaled: Array) -> float:
    """Return by how much values that follow their neighbours widen a variance [1].

    Only the autocorrelation that is clearly there counts: chance gives one of 1/√N.
    """
    power = float(scaled @ scaled)
    if power <= 0.0:
        return 1.0
    seen = float(scaled[1:] @ scaled[:-1]) / power
    rho = min(max(seen - 1.0 / np.sqrt(len(scaled)), 0.0), 0.8)
    return float((1 + rho) / (1 - rho))
