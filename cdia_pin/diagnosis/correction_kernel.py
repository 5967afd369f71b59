"""The bounds of a correction, compiled: they are asked twice a tick while an arm is not healthy."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def bounded(asked, before, velocity, effort, power, share, rise):
    """Return the torque that may be added [N·m or N], shape (n,), and whether any is.

    Args:
        asked: What is wanted, finite or not [N·m or N], shape (n,).
        before: What was added in the last tick [N·m or N], shape (n,).
        velocity: Of the joints [rad/s or m/s], shape (n,).
        effort: Most that is added [N·m or N], shape (n,); may be infinite.
        power: Most power that it puts into a joint [W], shape (n,); may be infinite.
        share: Share of it that is let through [1].
        rise: Most that it changes by since the last tick, over the effort [1].
    """
    added, any_added = np.zeros(len(asked)), False
    if share == 0.0:
        return added, any_added
    for j in range(len(asked)):
        torque = share * asked[j] if np.isfinite(asked[j]) else 0.0
        torque = min(max(torque, -effort[j]), effort[j])
        if torque * velocity[j] > power[j]:
            torque = power[j] / velocity[j]
        step = effort[j] * rise
        added[j] = min(max(torque, before[j] - step), before[j] + step)
        any_added |= added[j] != 0.0
    return added, any_added
