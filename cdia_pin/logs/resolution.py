"""Resolution: the step between the levels of a recorded signal."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FEW = 0.01  # [1], levels per sample below which a signal surely moves in steps
MOST = 0.8  # [1], levels per sample above which values hardly repeat: then steps must be multiples of different size


def quantum(signal: Array) -> float:
    """Estimate the step to which a signal is rounded.

    Args:
        signal: Values in any unit, shape (N,).

    Returns:
        The step [unit of the signal]; 0 if the values are practically continuous.
    """
    levels = np.unique(signal)
    count, step = len(levels), np.diff(levels)
    largest = max(-float(levels[0]), float(levels[-1])) if count else 0.0
    del levels  # as large as the signal where it is long and noisy, as is all below
    step = step[step > 1e-9 * max(largest, 1e-12)]
    if not len(step):
        return 0.0
    if count < FEW * len(signal):
        return float(step.min())
    if len(step) < 5:
        return 0.0
    smallest = float(np.percentile(step, 1))
    even = smallest > 0.5 * np.median(step) and count < 0.3 * len(signal)
    step /= smallest
    apart = step.min() > 0.9
    near = step[step < 20]
    del step
    off = np.round(near)
    off -= near
    multiples = np.mean(np.abs(off, out=off) < 0.1) > 0.95 and apart
    if count > MOST * len(signal):  # a joint at constant speed has equal steps and may be unrounded
        multiples = multiples and np.mean(near > 1.5) > FEW
    return smallest if len(near) >= 5 and (multiples or even) else 0.0
