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
    step = np.diff(levels)
    step = step[step > 1e-9 * max(float(np.abs(levels).max()), 1e-12)]
    if not len(step):
        return 0.0
    if len(levels) < FEW * len(signal):
        return float(step.min())
    if len(step) < 5:
        return 0.0
    smallest = float(np.percentile(step, 1))
    ratio = step / smallest
    near = ratio[ratio < 20]
    multiples = np.mean(np.abs(near - np.round(near)) < 0.1) > 0.95 and ratio.min() > 0.9
    if len(levels) > MOST * len(signal):  # a joint at constant speed has equal steps and may be unrounded
        multiples = multiples and np.mean(near > 1.5) > FEW
    even = smallest > 0.5 * np.median(step) and len(levels) < 0.3 * len(signal)
    return smallest if len(near) >= 5 and (multiples or even) else 0.0
