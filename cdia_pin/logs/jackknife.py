"""The standard error of an estimate from leaving out parts of a log in turn, the jackknife [Efron1982]."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def jackknife_error(left_out: Array) -> Array:
    """Return the standard error of estimates, in their unit, shape (...).

    Args:
        left_out: The estimates without each part, shape (parts, ...).
    """
    parts = len(left_out)
    scatter = left_out - left_out.mean(axis=0)
    return np.asarray(np.sqrt((parts - 1) / parts * np.sum(scatter**2, axis=0)))
