"""Resolution: the steps in which a signal was recorded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FEW = 0.01  # levels per sample of a signal that moves by a few steps only
MOST = 0.8  # levels per sample of a signal that hardly has a value twice


def quantum(signal: Array) -> float:
    """Return the step between the levels of a rounded signal (N,), 0 where values are as good as continuous."""
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
    if len(levels) > MOST * len(signal):  # even motion has one step all the time, and need not be rounded
        multiples = multiples and np.mean(near > 1.5) > FEW
    even = smallest > 0.5 * np.median(step) and len(levels) < 0.3 * len(signal)
    return smallest if len(near) >= 5 and (multiples or even) else 0.0
