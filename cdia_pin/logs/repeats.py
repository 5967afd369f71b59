"""After how many samples a motion repeats: excitation and work are often driven several times."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# RMS difference of each joint's position from itself one period later, over that of two unrelated positions [1], below
# which the motion repeats. Motions that a controller repeats are below 0.08, those that are driven once above 0.17.
ALIKE = 0.1
UNLIKE = (
    0.5  # the same [1], above which a joint has left where it was: a slow motion is like itself for a while
)
LEAST_REPEATED = 0.2  # share of the samples [1] that must repeat earlier ones for a period to be seen
MOVING = 0.02  # [rad or m], a joint with a smaller range rests, and repeats nothing


def period_of(q: Array) -> int | None:
    """Return after how many samples a motion repeats, or None if it does not.

    Args:
        q: Positions at an even pace [rad or m], shape (K, n).
    """
    moved = q[:, np.ptp(q, axis=0) > MOVING] if len(q) else q
    longest = int((1.0 - LEAST_REPEATED) * len(q))
    if not moved.size or longest < 1:
        return None
    different = np.max([_difference(x)[:longest] for x in moved.T], axis=0)
    left = np.flatnonzero(different > UNLIKE)
    back = np.flatnonzero(different[left[0] :] < ALIKE) + left[0] if len(left) else left
    if not len(back):
        return None
    leaves = np.flatnonzero(np.diff(back) > 1)
    once = back[: leaves[0] + 1] if len(leaves) else back
    return int(once[np.argmin(different[once])])


def _difference(x: Array) -> Array:
    """Return the RMS difference of a signal from itself some samples later, over that of unrelated values [1]."""
    from scipy.signal import correlate

    x = x - x.mean()
    count, power = len(x), np.cumsum(x**2)
    products = correlate(x, x, method="fft")[count - 1 :]
    later = power[-1] - np.concatenate([[0.0], power[:-1]])  # sums of squares without the first samples
    squares = (power[::-1] + later - 2.0 * products) / np.arange(count, 0, -1)
    return np.asarray(np.sqrt(np.maximum(squares, 0.0) / (2.0 * power[-1] / count)))
