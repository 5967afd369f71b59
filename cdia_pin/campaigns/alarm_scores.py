"""By how much a residual exceeds its threshold: what a detector with any other threshold would have said."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# [1], thresholds over those of the monitor at which alarms are counted
FACTORS = tuple(np.geomspace(0.25, 8.0, 41).tolist())
BLOCK = 1.0  # [s], in which several crossings are one alarm
QUIET = (
    1.0  # [s], in which the slowest filter of a monitor settles (5 time constants of 1/8 s): no alarm before
)


@dataclass(frozen=True)
class AlarmScores:
    """What a run says about thresholds.

    Attributes:
        peaks: Largest residual over threshold of each second without a fault, after the first one [1]. What is
            exceeded for fewer ticks than the debounce does not count.
        delays: Time from the onset to the first crossing of each of `FACTORS` times the threshold [s]; NaN for none.
    """

    peaks: tuple[float, ...]
    delays: tuple[float, ...]


def sustained(ratio: Array, ticks: int) -> Array:
    """Return the least of the last ticks at each tick, zero before there are so many.

    Args:
        ratio: |residual| over threshold [1], shape (K, n).
        ticks: Ticks in a row that make a detection.

    Returns:
        Shape (K, n).
    """
    from scipy.ndimage import minimum_filter1d

    if ticks <= 1 or not len(ratio):
        return ratio
    # The filter's window ends at the tick itself.
    lowest = minimum_filter1d(ratio, ticks, axis=0, mode="constant", cval=0.0, origin=(ticks - 1) // 2)
    return np.asarray(lowest)


def scores(ratio: Array, time: Array, debounce: int, onset: float, joints: NDArray[np.bool_]) -> AlarmScores:
    """Return what a run says about thresholds.

    Args:
        ratio: |residual| over threshold [1], shape (K, n).
        time: Time of the ticks [s], shape (K,).
        debounce: Ticks in a row that make a detection.
        onset: When the fault begins [s]; infinite without one.
        joints: Which joints have the fault, shape (n,).
    """
    held = sustained(ratio, debounce)
    before = (time < onset) & (time >= time[0] + QUIET)
    highest = held[before].max(axis=1, initial=0.0)
    per_block = max(1, round(BLOCK / float(np.median(np.diff(time)))) if len(time) > 1 else 1)
    whole = len(highest) // per_block  # what is left at the end is no whole second
    peaks = highest[: whole * per_block].reshape(whole, per_block).max(axis=1)
    late = time >= onset
    after = held[late][:, joints].max(axis=1, initial=0.0)
    delays = tuple(_first(after >= f, time[late] - onset) for f in FACTORS)
    return AlarmScores(tuple(peaks.tolist()), delays)


def most_peaks(healthy_time: float, rate: float) -> int:
    """Return the number of peaks that a run gives if it does not end before its time.

    Args:
        healthy_time: Time without a fault [s].
        rate: Ticks per second [Hz].
    """
    ticks = max(healthy_time - QUIET, 0.0) * rate + 1  # the first and the last one count
    return int(ticks / rate / BLOCK + 1e-9)


def alarms(peaks: Array, factor: float) -> int:
    """Count the alarms of a healthy run: seconds in a row with a crossing are one.

    Args:
        peaks: Of the seconds of one run [1], shape (B,).
        factor: Threshold over that of the monitor [1].
    """
    beyond = np.asarray(peaks) >= factor
    return int(np.count_nonzero(beyond & ~np.concatenate([[False], beyond[:-1]])))


def _first(true: NDArray[np.bool_], time: Array) -> float:
    return float(time[np.argmax(true)]) if true.any() else float("nan")
