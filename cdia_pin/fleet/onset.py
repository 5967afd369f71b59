r"""The onset of a change that is known to be there: when it began, and whether it came at once or grew.

A change that begins at log k and takes d logs adds :math:`\delta \min(1, (i - k + 1)/d)` to the values from log k on;
with d = 1 it is a step. The fit is that of `robust_fit`, beside the same regressors.

Where the change began and how long it took is known about as well as the fit tells changes apart. So the uncertainty of
its size holds that of its shape: each shape counts by its likelihood.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.fleet.alarm_limit import FEWEST_AFTER
from cdia_pin.fleet.robust_fit import ROUNDS, RobustFit, fit_once, usual_deviations
from cdia_pin.fleet.step_search import FEWEST_BEFORE, IMITATED

Array = NDArray[np.float64]

LENGTHENING = (
    1.05  # next duration over the one before [1]; with 1.4 the intervals of large changes hold 3 of 10 sizes
)
SLOWER = 10.0  # [1], fall of χ² for which a growth is believed instead of a step: 0.2 % by chance


@dataclass(frozen=True)
class Onset:
    """When a change began, and how long it took.

    Attributes:
        at: Index of the first log that shows it.
        logs: Number of logs in which it grew to its size; 1 for a step.
        fit: The fit of the regressors and, as its last column, of the change.
        deviation: Standard deviation of its size, that of its shape included, in the unit of the parameter.
    """

    at: int
    logs: int
    fit: RobustFit
    deviation: float

    @property
    def size(self) -> float:
        """Size δ of the change, in the unit of the parameter."""
        return float(self.fit.coefficients[-1])


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
        shapes = _Shapes.of(clipped, variance, regressors)
        at, logs = shapes.likeliest
        fit = fit_once(values, stated, _columns(regressors, at, logs), clipped, variance)
        clipped, variance = fit.clipped, fit.variance
    return Onset(at, logs, fit, shapes.deviation(float(fit.deviations[-1])))


@dataclass(frozen=True)
class _Shapes:
    """Every shape of a change: one of size one that begins at a log and takes some logs, M of them.

    Attributes:
        first: First log of each, shape (M,).
        logs: Number of logs of each, shape (M,).
        worth: Fall of χ² by each, less what a growth must explain more than a step [1], shape (M,).
        size: Size of each, in the unit of the parameter, shape (M,).
        variance: Variance of the size, if that is the shape, in the unit squared, shape (M,).
    """

    first: NDArray[np.intp]
    logs: NDArray[np.intp]
    worth: Array
    size: Array
    variance: Array

    @classmethod
    def of(cls, values: Array, variance: Array, regressors: Array) -> _Shapes:
        """Return all shapes of a course, fitted beside its regressors.

        Args:
            values: The values, shape (N,).
            variance: Their variance, shape (N,).
            regressors: What explains them besides, shape (N, p).
        """
        w = 1.0 / np.sqrt(variance)
        basis, _ = np.linalg.qr(regressors * w[:, None])
        left = w * values
        left = left - basis @ (basis.T @ left)
        first = np.arange(FEWEST_BEFORE, len(values) - FEWEST_AFTER + 1)
        rows = []
        for logs in _durations(len(values)):
            shapes = w[:, None] * _shape(len(values), first, logs)
            room = np.sum(shapes**2, axis=0) - np.sum((basis.T @ shapes) ** 2, axis=0)
            room = np.maximum(room, IMITATED * np.sum(w**2))
            gained = left @ shapes
            worth = gained**2 / room - (SLOWER if logs > 1 else 0.0)
            rows.append((first, np.full(len(first), logs), worth, gained / room, 1.0 / room))
        return cls(*(np.concatenate(column) for column in zip(*rows, strict=True)))

    @property
    def likeliest(self) -> tuple[int, int]:
        """The first log and the number of logs of the shape that explains most."""
        return int(self.first[self._best]), int(self.logs[self._best])

    @cached_property
    def _best(self) -> int:
        return int(np.argmax(self.worth))

    def deviation(self, alone: float) -> float:
        """Return the standard deviation of the size, in the unit of the parameter.

        Args:
            alone: That of the likeliest shape, if no other one were possible; values that follow their neighbours widen
                it, and so they do here.
        """
        k = self._best
        wider = alone**2 / self.variance[k]
        likelihood = np.exp((self.worth - self.worth[k]) / (2 * wider))
        share = likelihood / likelihood.sum()
        return float(np.sqrt(np.sum(share * (wider * self.variance + (self.size - self.size[k]) ** 2))))


def _durations(count: int) -> Iterator[int]:
    """Yield a step, and growths of a few logs up to all of them."""
    yield 1
    length = 2 * FEWEST_AFTER
    while length <= count:
        yield length
        length = math.ceil(length * LENGTHENING)


def _shape(count: int, first: NDArray[np.intp], logs: int) -> Array:
    """Return the changes of size one that begin at some logs, shape (count, len(first))."""
    return np.clip((np.arange(count)[:, None] - first[None, :] + 1) / logs, 0.0, 1.0)


def _columns(regressors: Array, at: int, logs: int) -> Array:
    return np.column_stack([regressors, _shape(len(regressors), np.array([at]), logs)])
