r"""The search for a step in a course: a robust regression with and without it.

A value of log i is explained by regressors, such as a constant and the temperature, and by a step at log k:

.. math::

    y_i = x_i^T b + \delta\, [i \ge k] + e_i, \qquad \mathrm{var}(e_i) = s_i^2 + \sigma^2

s is what the log itself says of its uncertainty, at least that of a usual log, and σ is what differs from log to log
besides. Both fits share the
regressors, so the temperature cannot take the step, nor the step the temperature, beyond what the data tell. Values far
from the fit count as if they were :math:`c` standard deviations away [Huber1981].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.fleet.alarm_limit import FEWEST_AFTER

Array = NDArray[np.float64]

CLIP = 2.5  # c, standard deviations [1] beyond which a value counts no more; a normal one is there in 1 % of the cases
CLIPPED_VARIANCE = 0.9556  # of a standard normal value that is clipped there [1]
ROUNDS = 3  # rounds [1] of weights and clipped values, which depend on each other
FEWEST_BEFORE = 5  # logs before a change [1], so that there is something to compare with
SMALLEST = 1e-300  # probability [1] that a double still holds
LEAST = 1e-6  # variance over the largest one that is possible [1]
HALVINGS = 14  # of six decades in which a variance is looked for [1]: to a thousandth of itself


@dataclass(frozen=True)
class Step:
    """The most likely step of a course.

    Attributes:
        at: Index of the first log after it.
        size: δ, in the unit of the parameter.
        deviation: Its standard deviation, in the unit of the parameter.
        z: Its size over its standard deviation, as a standard normal value of equal probability [1].
        coefficients: b, one for each regressor.
        coefficient_deviations: Their standard deviations.
        spread: Standard deviation of a value of a usual log, in the unit of the parameter.
    """

    at: int
    size: float
    deviation: float
    z: float
    coefficients: Array
    coefficient_deviations: Array
    spread: float


def find_step(values: Array, deviations: Array, regressors: Array) -> Step | None:
    """Return the most likely step of a course; None if it has too few logs.

    Args:
        values: The parameter in each log, shape (N,).
        deviations: Standard deviation of each value as its log states it, shape (N,).
        regressors: What explains the values besides, a constant among them, shape (N, p).
    """
    count, p = regressors.shape
    freedom = count - p - 1
    if count < FEWEST_BEFORE + FEWEST_AFTER or freedom < FEWEST_BEFORE:
        return None
    # a dozen blocks do not tell a standard deviation well: no log counts for more than a usual one
    deviations = np.maximum(deviations, np.median(deviations))
    # first without a step, so that one bad log does not pass for one
    clipped, variance = values, deviations**2 + 1e-300
    for _ in range(ROUNDS):
        fitted = weighted_fit(clipped, variance, regressors)[0]
        clipped, variance = clipped_values(values, fitted, deviations, (freedom + 1) / count)
    at = 0
    for _ in range(ROUNDS):
        at = _likeliest(clipped, variance, regressors)
        fitted = weighted_fit(clipped, variance, _with_step(regressors, at))[0]
        clipped, variance = clipped_values(values, fitted, deviations, freedom / count)
    at = _likeliest(clipped, variance, regressors)
    fitted, b, covariance = weighted_fit(clipped, variance, _with_step(regressors, at))
    scaled = np.clip((values - fitted) / np.sqrt(variance), -CLIP, CLIP)
    covariance = covariance * _inflation(scaled)
    spread = np.sqrt(np.diag(covariance))
    return Step(
        at,
        float(b[-1]),
        float(spread[-1]),
        _normal(float(b[-1] / spread[-1]), freedom),
        b[:-1],
        spread[:-1],
        float(np.sqrt(np.median(variance))),
    )


def clipped_values(values: Array, fitted: Array, deviations: Array, share: float) -> tuple[Array, Array]:
    """Return the values, no further from the fit than counts, and their variance, shape (N,) each.

    Args:
        values: Shape (N,).
        fitted: The fit, shape (N,).
        deviations: What the logs state, shape (N,).
        share: Degrees of freedom of the fit over the number of logs [1].
    """
    variance = _variance(values - fitted, deviations, share)
    reach = CLIP * np.sqrt(variance)
    return fitted + np.clip(values - fitted, -reach, reach), variance


def _with_step(regressors: Array, at: int) -> Array:
    step = np.zeros(len(regressors))
    step[at:] = 1.0
    return np.column_stack([regressors, step])


def _likeliest(values: Array, variance: Array, regressors: Array) -> int:
    """Return the index after the step that explains most, shape of the sums (N, p)."""
    w = 1.0 / np.sqrt(variance)
    basis, _ = np.linalg.qr(regressors * w[:, None])
    left = w * values
    left = left - basis @ (basis.T @ left)
    gained = _sums(w * left)
    common = _sums(w[:, None] * basis)
    room = np.maximum(_sums(w**2) - np.sum(common**2, axis=1), 1e-300)
    explained = gained**2 / room
    # a step that the regressors can imitate says nothing
    explained[room < 1e-6 * np.sum(w**2)] = 0.0
    allowed = slice(FEWEST_BEFORE, len(values) - FEWEST_AFTER + 1)
    return FEWEST_BEFORE + int(np.argmax(explained[allowed]))


def _sums(x: Array) -> Array:
    """Return the sum of each row and all later ones."""
    return np.asarray(np.cumsum(x[::-1], axis=0)[::-1])


def weighted_fit(values: Array, variance: Array, columns: Array) -> tuple[Array, Array, Array]:
    """Return the fitted values (N,), the coefficients (p,) and their covariance (p, p).

    Args:
        values: Shape (N,).
        variance: Of each value, shape (N,).
        columns: Shape (N, p).
    """
    w = 1.0 / np.sqrt(variance)
    inverse = np.linalg.pinv(columns * w[:, None])
    b = inverse @ (w * values)
    return columns @ b, b, inverse @ inverse.T


def _variance(left: Array, deviations: Array, share: float) -> Array:
    """Return the variance of each value, so that what is left has it, shape (N,).

    Args:
        left: What the fit leaves, shape (N,).
        deviations: What the logs state, shape (N,).
        share: Degrees of freedom over the number of logs [1].
    """
    wanted = CLIPPED_VARIANCE * share

    def size(variance: Array) -> float:
        return float(np.mean(np.minimum(left**2 / variance, CLIP**2)))

    squares, stated = left**2, deviations**2 + 1e-300
    most = CLIP**2

    def is_too_small(variance: Array) -> bool:
        return float(np.minimum(squares / variance, most).mean()) > wanted

    more = is_too_small(stated)  # than the logs state; else they scatter less
    low, high = (
        (LEAST * float(squares.max()) / wanted, float(squares.max()) / wanted) if more else (LEAST, 1.0)
    )
    for _ in range(HALVINGS):
        middle = (low * high) ** 0.5
        trial = stated + middle if more else stated * middle
        low, high = (middle, high) if is_too_small(trial) else (low, middle)
    return np.asarray(stated + high if more else stated * high)


def _inflation(scaled: Array) -> float:
    """Return by how much values that follow their neighbours widen a variance [1].

    Only the autocorrelation that is clearly there counts: chance gives one of 1/√N.
    """
    power = float(scaled @ scaled)
    if power <= 0.0:
        return 1.0
    seen = float(scaled[1:] @ scaled[:-1]) / power
    rho = min(max(seen - 1.0 / np.sqrt(len(scaled)), 0.0), 0.8)
    return (1 + rho) / (1 - rho)


def _normal(t: float, freedom: int) -> float:
    """Return the standard normal value that is as improbable as a value of Student's distribution."""
    from scipy.special import ndtri, stdtr

    return float(np.copysign(-ndtri(max(stdtr(freedom, -abs(t)), SMALLEST)), t))
