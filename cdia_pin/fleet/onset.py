r"""The onset of a change that is known to be there: when it began, and whether it came at once or grew.

A change that begins at log k and takes d logs adds :math:`\delta \min(1, (i - k + 1)/d)` to the values from log k on;
with d = 1 it is a step. The fit is that of `robust_fit`, beside the same regressors.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.fleet.alarm_limit import FEWEST_AFTER
from cdia_pin.fleet.robust_fit import ROUNDS, RobustFit, fit_once, usual_deviations
from cdia_pin.fleet.step_search import FEWEST_BEFORE

Array = NDArray[np.float64]

LENGTHENING = 1.4  # next duration over the one before [1]; finer ones fit alike
SLOWER = 10.0  # [1], fall of χ² for which a growth is believed instead of a step: 0.2 % by chance


@dataclass(frozen=True)
class Onset:
    """When a change began, and how long it took.

    Attributes:
        at: Index of the first log that shows it.
        logs: Number of logs in which it grew to its size; 1 for a step.
        fit: The fit of the regressors and, as its last column, of the change.
    """

    at: int
    logs: int
    fit: RobustFit

    @property
    def size(self) -> float:
        """Size δ of the change, in the unit of the parameter."""
        return float(self.fit.coefficients[-1])

    @property
    def deviation(self) -> float:
        """Standard deviation of the size, in the unit of the parameter."""
        return float(self.fit.deviations[-1])


def find_onset(values: Array, deviations: Array, regressors: Array) -> Onset:
    """Return the most likely onset of a change.

    Args:
        values: The parameter in each log, shape (N,).
        deviations: Standard deviation of each value as its log states it, shape (N,).
        regressors: What explains the values besides, a constant first, shape (N, p).
    """
    stated = usual_deviations(deviations)
    clipped, variance = values, stated**2 + 1e-300
    for _ in range(ROUNDS + 1):
        at, logs = _likeliest(clipped, variance, regressors)
        fit = fit_once(values, stated, _columns(regressors, at, logs), clipped, variance)
        clipped, variance = fit.clipped, fit.variance
    return Onset(at, logs, fit)


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
