"""How often a joint turns back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FAST = 0.05  # [1], speed over the largest one, above which it is motion and not noise at rest


def is_fast(v: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return in which samples a joint surely moves, shape (N,).

    Args:
        v: Its velocity [rad/s or m/s], shape (N,).
    """
    speed = np.abs(v)
    return np.asarray(speed > FAST * speed.max(initial=0.0))


def reversals(v: NDArray[np.float64]) -> int:
    """Count how often a joint moves against its direction before [1].

    Args:
        v: Its velocity [rad/s or m/s], shape (N,).
    """
    return int(np.sum(np.diff(np.sign(v[is_fast(v)])) != 0))
