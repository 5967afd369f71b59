"""The bounds of a correction and of a command, compiled: they are asked twice a tick while an arm is not healthy.

They fill arrays of the caller: that is quicker than to return new ones.
"""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def bounded(asked, before, velocity, effort, power, share, rise, added):
    """Fill in the torque that may be added; return whether any is.

    Args:
        asked: What is wanted, finite or not [N·m or N], shape (n,).
        before: What was added in the last tick [N·m or N], shape (n,).
        velocity: Of the joints [rad/s or m/s], shape (n,).
        effort: Most that is added [N·m or N], shape (n,); may be infinite.
        power: Most power that it puts into a joint [W], shape (n,); may be infinite.
        share: Share of it that is let through [1].
        rise: Most that it changes by since the last tick, over the effort [1].
        added: The torque; filled [N·m or N], shape (n,).
    """
    any_added = False
    if share == 0.0:
        added[:] = 0.0
        return any_added
    for j in range(len(asked)):
        torque = share * asked[j] if np.isfinite(asked[j]) else 0.0
        torque = min(max(torque, -effort[j]), effort[j])
        if torque * velocity[j] > power[j]:
            torque = power[j] / velocity[j]
        step = effort[j] * rise
        added[j] = min(max(torque, before[j] - step), before[j] + step)
        any_added |= added[j] != 0.0
    return any_added


@njit(cache=True)
def is_usual(signal, most):
    """Return whether all of a signal is finite and below a bound; not a number is not.

    Args:
        signal: Of the joints, shape (n,).
        most: The bound, in its unit.
    """
    usual = True
    for value in signal:
        usual &= abs(value) < most
    return usual


@njit(cache=True)
def command(nominal, added, effort, out):
    """Fill in the sum of two torques within the effort limits.

    Args:
        nominal: What the control law asks for [N·m or N], shape (n,).
        added: What is added to it [N·m or N], shape (n,).
        effort: Effort limits [N·m or N], shape (n,); may be infinite.
        out: The torque to command; filled [N·m or N], shape (n,).
    """
    for j in range(len(nominal)):
        out[j] = min(max(nominal[j] + added[j], -effort[j]), effort[j])
    return out


@njit(cache=True)
def corrected_command(nominal, wanted, before, velocity, effort, power, share, rise, limit, added, out):
    """Fill in what may be added to a nominal torque, and the torque to command; return whether any is added.

    Args:
        nominal: What the control law asks for [N·m or N], shape (n,).
        wanted: What an engine wants instead, finite or not [N·m or N], shape (n,).
        before: What was added in the last tick, and so on, see `bounded`.
        velocity: See `bounded`.
        effort: See `bounded`.
        power: See `bounded`.
        share: See `bounded`.
        rise: See `bounded`.
        limit: Effort limits [N·m or N], shape (n,); may be infinite.
        added: What is added; filled [N·m or N], shape (n,).
        out: The torque to command; filled [N·m or N], shape (n,).
    """
    for j in range(len(nominal)):
        added[j] = wanted[j] - nominal[j]
    any_added = bounded(added, before, velocity, effort, power, share, rise, added)
    command(nominal, added, limit, out)
    return any_added
