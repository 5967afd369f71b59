"""Errors over the torque of each joint."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEAST = 1e-12  # torque [N·m or N] that stands for one of exactly zero


def mean_share(
    errors: Array | Sequence[float], torque: Array, counted: NDArray[np.bool_] | None = None
) -> float:
    """Return error over torque, mean over the joints that count [1].

    A joint of which no sample counts has neither an error nor a torque, and is left out.

    Args:
        errors: RMS of each joint [N·m or N], shape (n,).
        torque: RMS measured torque of each joint [N·m or N], shape (n,).
        counted: True for the joints that count, shape (n,); all if omitted.
    """
    error = np.asarray(errors)
    counts = ((error > 0) | (torque > 0)) & (True if counted is None else counted)
    return float(np.mean(error[counts] / np.maximum(torque[counts], LEAST))) if counts.any() else 0.0
