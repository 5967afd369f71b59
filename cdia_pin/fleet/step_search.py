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
HALVINGS = 40  # of the interval in which σ is looked for [1]


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
    clipped, variance = values, deviations**2 + np.var(values) * 1e-12 + 1e-300
    at, fitted = 0, np.zeros(count)
    for _ in range(ROUNDS):
        at = _likeliest(clipped, variance, regressors)
        fitted = _fit(clipped, variance, _with_step(regressors, at))[0]
        variance = _variance(values - fitted, deviations, freedom / count)
        reach = CLIP * np.sqrt(variance)
        clipped = fitted + np.clip(values - fitted, -reach, reach)
    at = _likeliest(clipped, variance, regressors)
    fitted, b, covariance = _fit(clipped, variance, _with_step(regressors, at))
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


def _fit(values: Array, variance: Array, columns: Array) -> tuple[Array, Array, Array]:
    """Return the fitted values (N,), the coefficients (p,) and their covariance (p, p)."""
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

    stated = deviations**2 + 1e-300
    if size(stated) <= wanted:  # logs that scatter less than they state
        low, high = 1e-6, 1.0
        for _ in range(HALVINGS):
            middle = np.sqrt(low * high)
            low, high = (middle, high) if size(stated * middle) > wanted else (low, middle)
        return np.asarray(stated * high)
    low, high = 0.0, float(np.max(left**2)) / wanted + 1e-300
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if size(stated + middle) > wanted else (low, middle)
    return np.asarray(stated + high)


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
    from scipy.special import ndtri_exp
    from scipy.stats import t as student

    return float(np.copysign(-ndtri_exp(student.logsf(abs(t), freedom)), t))
