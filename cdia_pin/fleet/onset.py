r"""The onset of a change that is known to be there: when it began, and whether it came at once or grew.

A change that begins at log k and takes d logs adds :math:`\delta \min(1, (i - k + 1)/d)` to the values from log k on;
with d = 1 it is a step. The fit is that of `step_search`: the same regressors, and values far away count no more.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.fleet.alarm_limit import FEWEST_AFTER
from cdia_pin.fleet.step_search import FEWEST_BEFORE, clipped_values, weighted_fit

Array = NDArray[np.float64]

ROUNDS = 3  # rounds [1] of weights and clipped values, which depend on each other
LENGTHENING = 1.4  # next duration over the one before [1]; finer ones fit alike
SLOWER = 10.0  # [1], fall of χ² for which a growth is believed instead of a step: 0.2 % by chance


@dataclass(frozen=True)
class Onset:
    """When a change began, and how long it took.

    Attributes:
        at: Index of the first log that shows it.
        logs: Number of logs in which it grew to its size; 1 for a step.
        size: δ, in the unit of the parameter.
        deviation: Its standard deviation, in the unit of the parameter.
        level: The parameter before, at mean regressors.
        fitted: Regressors and change, shape (N,).
    """

    at: int
    logs: int
    size: float
    deviation: float
    level: float
    fitted: Array


def find_onset(values: Array, deviations: Array, regressors: Array) -> Onset:
    """Return the most likely onset of a change.

    Args:
        values: The parameter in each log, shape (N,).
        deviations: Standard deviation of each value as its log states it, shape (N,).
        regressors: What explains the values besides, a constant first, shape (N, p).
    """
    deviations = np.maximum(deviations, np.median(deviations))
    freedom = 1 - (regressors.shape[1] + 2) / len(values)
    clipped, variance = values, deviations**2 + 1e-300
    at, logs, fitted = 0, 1, values
    for _ in range(ROUNDS):
        at, logs = _likeliest(clipped, variance, regressors)
        fitted = weighted_fit(clipped, variance, _columns(regressors, at, logs))[0]
        clipped, variance = clipped_values(values, fitted, deviations, freedom)
    fitted, b, covariance = weighted_fit(clipped, variance, _columns(regressors, at, logs))
    return Onset(at, logs, float(b[-1]), float(np.sqrt(covariance[-1, -1])), float(b[0]), fitted)


def _likeliest(values: Array, variance: Array, regressors: Array) -> tuple[int, int]:
    """Return the first log and the duration of the change that explains most."""
    w = 1.0 / np.sqrt(variance)
    basis, _ = np.linalg.qr(regressors * w[:, None])
    left = w * values
    left = left - basis @ (basis.T @ left)
    first = np.arange(FEWEST_BEFORE, len(values) - FEWEST_AFTER + 1)
    best, choice = -np.inf, (int(first[0]), 1)
    for logs in _durations(len(values)):
        shapes = w[:, None] * _shape(len(values), first, logs)
        room = np.sum(shapes**2, axis=0) - np.sum((basis.T @ shapes) ** 2, axis=0)
        explained = (left @ shapes) ** 2 / np.maximum(room, 1e-9 * np.sum(w**2))
        k = int(np.argmax(explained))
        worth = float(explained[k]) - (SLOWER if logs > 1 else 0.0)
        if worth > best:
            best, choice = worth, (int(first[k]), logs)
    return choice


def _durations(count: int) -> Iterator[int]:
    """Yield a step, and growths of a few logs up to all of them."""
    yield 1
    length = 2.0 * FEWEST_AFTER
    while length <= count:
        yield int(length)
        length *= LENGTHENING


def _shape(count: int, first: NDArray[np.intp], logs: int) -> Array:
    """Return the changes of size one that begin at some logs, shape (count, len(first))."""
    return np.clip((np.arange(count)[:, None] - first[None, :] + 1) / logs, 0.0, 1.0)


def _columns(regressors: Array, at: int, logs: int) -> Array:
    return np.column_stack([regressors, _shape(len(regressors), np.array([at]), logs)])
