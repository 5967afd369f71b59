"""How often a joint turns back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Less is noise of a position at rest or in slow motion. With half of it encoder steps of 1.5 mrad make thirty turns of
# four; with twice of it nine of ten joints of 14 logs turn as often.
BACK = 0.02  # [1], distance over the range of a joint, above which it has turned
FAST = 0.05  # [1], speed over the largest one, above which it is motion and not noise at rest


def is_fast(v: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return in which samples a joint surely moves, shape (N,).

    Args:
        v: Its velocity [rad/s or m/s], shape (N,).
    """
    speed = np.abs(v)
    return np.asarray(speed > FAST * speed.max(initial=0.0))


def reversals(v: NDArray[np.float64]) -> int:
    """Count how often a joint turns and goes back [1].

    Args:
        v: Its velocity [rad/s or m/s] at even steps of time, shape (N,).
    """
    place = np.cumsum(v)  # position, in the distance that unit speed makes in a step
    least = BACK * np.ptp(place) if len(place) else 0.0
    turns = np.flatnonzero(np.diff(np.sign(v)) != 0)
    count, way, farthest = 0, 0.0, place[0] if len(place) else 0.0
    for now in [*place[turns].tolist(), *place[-1:].tolist()]:
        gone = now - farthest
        if way * gone > 0 or way == 0:  # farther the same way
            way = np.sign(gone) if abs(gone) > least else way
            farthest = now if way else farthest
        elif abs(gone) > least:
            count, way, farthest = count + 1, -way, now
    return count
