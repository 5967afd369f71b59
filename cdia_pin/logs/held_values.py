"""Wrong values that are held: a position jumps away between two samples, stands still there, and jumps back.

A joint that comes to rest does not arrive in one sample at several times its largest speed. Values that a recorder
holds between slow updates jump too, but as far elsewhere as there.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.recorded_parts import LONGEST_GAP

Array = NDArray[np.float64]

JUMP = 3.0  # [1], speed of both jumps over the largest one elsewhere
OFTEN = 1.0  # [1/s], runs that come more often are how the signal was recorded


def held_runs(
    x: Array, time: Array, large: float, fastest: float, wild: Iterable[int]
) -> list[tuple[int, int]]:
    """Find the runs of equal values to which a position jumps, and from which it jumps back, within 0.5 s.

    Across a longer run nothing could be interpolated.

    Args:
        x: Positions of a joint [rad or m], shape (N,).
        time: Times [s], shape (N,).
        large: Smallest jump that is looked at [rad or m].
        fastest: Largest acceleration of any joint [rad/s² or m/s²].
        wild: Rows that are known to be wrong.

    Returns:
        First row and row after the last of each run.
    """
    step, period = np.diff(x), np.diff(time)
    jumps = np.flatnonzero(~(np.abs(step) <= large))
    first, last = jumps[:-1], jumps[1:]
    near = (last - first > 1) & (time[last] - time[first + 1] <= LONGEST_GAP)
    back = near & (np.sign(step[first]) == -np.sign(step[last]))
    found = [
        (i, j)
        for i, j in zip(first[back].tolist(), last[back].tolist(), strict=True)
        if not step[i + 1 : j].any()
        and all(abs(step[k]) > fastest * period[k] ** 2 / 2 for k in (i, j))  # to rest within a sample
    ]
    if not found or len(found) > max(1.0, OFTEN * float(time[-1] - time[0])):
        return []
    speed = np.abs(step) / period
    others = speed.copy()
    others[np.array(found).ravel()] = 0.0
    rows = np.array(sorted(wild), dtype=np.intp)
    others[np.concatenate([rows[rows < len(others)], rows[rows > 0] - 1])] = 0.0
    usual = JUMP * float(others.max())
    return [(i + 1, j + 1) for i, j in found if min(speed[i], speed[j]) > usual]
