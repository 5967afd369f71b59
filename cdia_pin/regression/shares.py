"""Errors over the torque of each joint."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEAST = 1e-12  # torque [N·m or N] below which a joint has none


def mean_share(
    errors: Array | Sequence[float], torque: Array, counted: NDArray[np.bool_] | None = None
) -> float:
    """Return error over torque, mean over the joints that count [1].

    A joint without torque, as one of which no sample counts or whose effort was not recorded, is left out.

    Args:
        errors: RMS of each joint [N·m or N], shape (n,).
        torque: RMS measured torque of each joint [N·m or N], shape (n,).
        counted: True for the joints that count, shape (n,); all if omitted.
    """
    error, size = np.asarray(errors), np.asarray(torque)
    counts = (size > LEAST) & (True if counted is None else counted)
    return float(np.mean(error[counts] / size[counts])) if counts.any() else 0.0
