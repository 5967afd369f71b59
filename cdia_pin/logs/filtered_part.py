"""A part of a log, filtered and thinned: so a long log is conditioned part by part, with memory that does not grow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.derivatives import BLOCK, MARGIN, smooth_motion, zero_phase
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

STRETCH = 1.0  # [s], length of the pieces of a log of which the one with the largest acceleration counts


@dataclass(frozen=True)
class Filter:
    """How a part of a log is filtered.

    Attributes:
        cutoff: Cut-off of the compared torques [Hz].
        motion: Cut-off of the filter that positions and torques pass [Hz].
        rate: Rate of the log [Hz].
        every: Samples of the log for each one that is kept [1].
        stepless: Cut-off of a motion that holds no steps of the encoder any more [Hz].
        steps: Step of each encoder [rad or m], shape (n,); 0 where positions are not rounded.
    """

    cutoff: float
    motion: float
    rate: float
    every: int
    stepless: float
    steps: Array

    @property
    def margin(self) -> int:
        """Samples that the filter needs before and after a part [1]."""
        return int(np.ceil(MARGIN * self.rate / self.cutoff))

    @property
    def block(self) -> int:
        """Samples of a part that is filtered at once [1]; with its neighbours, it is a block of `zero_phase`."""
        return max(BLOCK - 2 * self.margin, BLOCK // 2)

    def around(self, part: slice, within: slice) -> slice:
        """Return a part with the neighbours that the filter needs, and some more where its transforms are faster then.

        Args:
            part: The part.
            within: Samples of the log that may be neighbours: those between two gaps.
        """
        from scipy.fft import next_fast_len

        start, stop = max(part.start - self.margin, within.start), min(part.stop + self.margin, within.stop)
        count = within.stop - within.start
        if stop - start == count:
            return within
        length = min(
            next_fast_len(stop - start - 1, real=True) + 1, count
        )  # `zero_phase` transforms 2 N − 2 values
        start = max(min(start, within.stop - length), within.start)
        return slice(start, start + length)


@dataclass(frozen=True, repr=False)
class FilteredPart:
    """Signals of a part of a log, one sample of `Filter.every`, and what all samples of it tell.

    Attributes:
        q: Positions [rad or m], shape (N, n).
        v: Velocities [rad/s or m/s], shape (N, n).
        a: Accelerations [rad/s² or m/s²], shape (N, n).
        effort: Torques [N·m or N], shape (N, n).
        temperature: Temperatures [°C], shape (N, n); None if they were not recorded.
        removed: Variance of what the filter removed from the positions [rad² or m²], shape (n,).
        rounding: Power of the compared acceleration that rounding of the positions leaves [(rad/s²)²], shape (n,).
        busiest: Power of the compared acceleration in the second where it is largest [(rad/s²)²], shape (n,).
        count: Samples of the log in this part [1].
    """

    q: Array
    v: Array
    a: Array
    effort: Array
    temperature: Array | None
    removed: Array
    rounding: Array
    busiest: Array
    count: int

    @classmethod
    def of(cls, even: Log, part: slice, within: slice, by: Filter) -> Self:
        """Filter a part together with the neighbours that the filter needs.

        Args:
            even: A uniformly sampled log.
            part: Its samples that are wanted.
            within: Its samples that may be their neighbours: those between two gaps.
            by: The filter.
        """
        around = by.around(part, within)
        inside = slice(part.start - around.start, part.stop - around.start)
        raw = even.position[around]
        q, v, a = smooth_motion(raw, by.motion, by.rate)
        effort = zero_phase(even.effort[around], by.motion, by.rate)
        warmth = None if even.temperature is None else even.temperature[around]
        return cls(
            q[inside][:: by.every].copy(),
            v[inside][:: by.every].copy(),
            a[inside][:: by.every].copy(),
            effort[inside][:: by.every].copy(),
            None if warmth is None else zero_phase(warmth, by.motion, by.rate)[inside][:: by.every],
            np.var(raw[inside] - q[inside], axis=0),
            _rounding(raw, inside, by),
            _busiest(zero_phase(a, by.cutoff, by.rate)[inside], by.rate),
            part.stop - part.start,
        )


def mean(values: Sequence[Array], parts: Sequence[FilteredPart]) -> Array:
    """Return the mean of a value of each part over all samples, shape (n,).

    Args:
        values: One value per part, shape (n,) each.
        parts: The parts.
    """
    if len(values) == 1:
        return values[0]
    return np.asarray(np.average(values, axis=0, weights=[p.count for p in parts]))


def _busiest(a: Array, rate: float) -> Array:
    """Return the power of each compared acceleration in the second where it is largest [(rad/s²)²], shape (n,)."""
    count = max(1, min(len(a), int(len(a) / (STRETCH * rate))))
    return np.asarray(np.max([np.mean(piece**2, axis=0) for piece in np.array_split(a, count)], axis=0))


def _rounding(position: Array, inside: slice, by: Filter) -> Array:
    """Estimate the power of the compared acceleration that rounding of the positions leaves, shape (n,).

    It is 0 for positions that are not rounded. Rounding noise is not white where a joint moves evenly, and it beats
    where the steps of the encoder meet the samples. So a much smoother motion is rounded once more.
    """
    if not by.steps.any():
        return by.steps
    safe, smooth = np.where(by.steps > 0, by.steps, 1.0), zero_phase(position, by.stepless, by.rate)
    error = np.where(by.steps > 0, np.round(smooth / safe) * safe - smooth, 0.0)
    again = zero_phase(error, by.cutoff, by.rate, derivative=2)
    return np.asarray(np.mean(again[inside] ** 2, axis=0))
