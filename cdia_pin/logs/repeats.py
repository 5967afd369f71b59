"""After how many samples a motion repeats: excitation and work are often driven several times."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.motion import STANDSTILL

Array = NDArray[np.float64]

# On 61 logs of twelve arms, of which 25 repeat, about half and twice the values below decide alike, but for two logs.
# Distances are over the RMS distance of unrelated positions. Motions that a controller repeats are 0.08 RMS apart at
# most, others 0.17 or more.
ALIKE = 0.25  # distance [1] from the position one period earlier below which a joint is back: 3 × 0.08
MOSTLY = 0.6  # share of the samples [1] at which all joints must be back: a log may begin and end with a ramp
UNLIKE = 0.5  # RMS distance [1] above which a joint has left where it was: a slow motion is like itself for a while
LEAST_REPEATED = 0.2  # share of the samples [1] that must repeat earlier ones for a period to be seen


def period_of(q: Array) -> int | None:
    """Return after how many samples a motion repeats, or None if it does not.

    Args:
        q: Positions at an even pace [rad or m], shape (K, n).
    """
    moved = q[:, np.ptp(q, axis=0) > STANDSTILL] if len(q) else q
    longest = int((1.0 - LEAST_REPEATED) * len(q))
    if not moved.size or longest < 1:
        return None
    size = np.sqrt(2.0) * moved.std(axis=0)
    lags = np.arange(longest)
    different = np.max([_difference_at(lags, x, x) / s for x, s in zip(moved.T, size, strict=True)], axis=0)
    left = np.flatnonzero(different > UNLIKE)
    for lag in _minima(different, int(left[0]), longest) if len(left) else ():
        back = (np.abs(moved[lag:] - moved[:-lag]) < ALIKE * size).all(axis=1)
        if back.mean() >= MOSTLY:
            return lag
    return None


def lag_between(first: Array, second: Array) -> int | None:
    """Return how many samples after one log another begins, if both drive the same motion; None if they do not.

    Args:
        first: Positions of the one at an even pace [rad or m], shape (K, n).
        second: Those of the other at the same pace, shape (L, n). It may begin earlier: the lag is negative then.
    """
    moves = (np.ptp(first, axis=0) > STANDSTILL) | (np.ptp(second, axis=0) > STANDSTILL)
    least = int(MOSTLY * max(len(first), len(second)))  # samples that both must have
    if not moves.any() or least > min(len(first), len(second)):
        return None
    first, second = first[:, moves], second[:, moves]
    size = np.sqrt(2.0) * np.maximum(first.std(axis=0), second.std(axis=0))
    lags = np.arange(least - len(second), len(first) - least + 1)
    different = [_difference_at(lags, x, y) / s for x, y, s in zip(first.T, second.T, size, strict=True)]
    lag = int(lags[np.max(different, axis=0).argmin()])
    begin, end = max(lag, 0), min(lag + len(second), len(first))
    back = (np.abs(first[begin:end] - second[begin - lag : end - lag]) < ALIKE * size).all(axis=1)
    return lag if back.mean() >= MOSTLY else None


def _difference_at(lags: NDArray[np.intp], x: Array, y: Array) -> Array:
    """Return the RMS difference of one signal from another one that begins some samples later, shape of the lags."""
    # scipy.signal.correlate does the same, but its import takes half a second
    from scipy.fft import irfft, next_fast_len, rfft

    mean = x.mean()
    x, y = x - mean, y - mean
    length = next_fast_len(len(x) + len(y), real=True)
    products = irfft(rfft(x, length) * np.conj(rfft(y, length)), length)[lags]  # negative lags are at the end
    power_x, power_y = (np.concatenate([[0.0], np.cumsum(s**2)]) for s in (x, y))
    begin, end = np.maximum(lags, 0), np.minimum(lags + len(y), len(x))
    both = power_x[end] - power_x[begin] + power_y[end - lags] - power_y[begin - lags]
    return np.asarray(np.sqrt(np.maximum(both - 2.0 * products, 0.0) / (end - begin)))


def _minima(x: Array, start: int, stop: int) -> list[int]:
    """Return where a signal is lower than before and no higher than after, between two samples."""
    return [k for k in range(max(start, 1), stop - 1) if x[k] < x[k - 1] and x[k] <= x[k + 1]]
