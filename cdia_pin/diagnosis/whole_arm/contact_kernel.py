"""The arithmetic of contact, compiled: `contact` says what it means."""

from __future__ import annotations

import numpy as np
from numba import njit

from cdia_pin.diagnosis.kernels import ROUGHNESS
from cdia_pin.diagnosis.whole_arm.contact_rows import (
    BEGUN,
    CHANGING,
    DEVIATION,
    ENDED,
    FOLLOWS,
    FRICTION,
    LASTED,
    LIMIT,
    MOVING,
    PEAK,
    PRESENT,
    RECOVERED,
    REST,
    SLOW,
    SLOW_LOAD,
)

SLOW_TIME = 2.0  # [s], time constant of the part that is followed: a push rises and falls within it
RESTING = 0.05  # [1], share of the filter's memory in motion, below which a joint rests
STARTING = 0.02  # [1], the same share: between it and one less it, a joint starts or stops
FIRST = 1.0  # [1], deviation over its limit that the joint with the largest one must have
SECOND = 0.7  # [1], the same of the next joint: a push reaches two at least, if not alike
TOGETHER = 0.4  # [s], within which both must have begun: a push reaches all joints at once
BEGINNING = 0.35  # [1], deviation over its limit, from which it has begun
OVER = 0.5  # [1], deviation over its limit, below which all joints must be for a contact to be gone
RELEASED = 0.15  # [1], deviation over the largest one of the contact, below which a joint counts as back
HELD = 0.35  # [1], the same, where friction may hold what is left
RECOVERY = 1.0  # [s] after a contact, in which joints come back one after another, as friction lets them go
QUICK_TIME = 0.2  # [s], time constant of the part that is followed in that time
DEBOUNCE = 0.02  # [s] for which a contact must be there, or gone, before it counts


@njit(cache=True, error_model="numpy")
def follow(limits, state, scalars, remainder, moving, load, believed, t, dt):
    """Take a sample: follow the slow parts, and notice when contact begins or ends.

    Args:
        limits: Largest deviations of a healthy arm, shape (rows, n).
        state: State of the detector, shape (rows, n).
        scalars: Its numbers.
        remainder: Residual less the torque of what is believed [N·m or N], shape (n,).
        moving: Share of the filter's memory in which each joint moved [1], shape (n,).
        load: What gravity and motion take of each joint by the model [N·m or N], shape (n,).
        believed: Largest torque of what is believed of each joint of late [N·m or N], shape (n,). Its formula may miss
            a share of it.
        t: Time [s].
        dt: Time since the last sample [s].
    """
    slow, quick = np.exp(-dt / SLOW_TIME), np.exp(-dt / QUICK_TIME)
    present = scalars[PRESENT] > 0.0
    back = True
    first = second = -np.inf  # the largest deviations over their limits
    begun_first = begun_second = np.inf
    for j in range(len(remainder)):
        if scalars[FOLLOWS] == 0.0:
            state[SLOW, j], state[SLOW_LOAD, j] = remainder[j], load[j]
        deviation = remainder[j] - state[SLOW, j]
        changing = 1.0 if STARTING < moving[j] < 1.0 - STARTING else slow * state[CHANGING, j]
        state[SLOW_LOAD, j] += (1.0 - slow) * (load[j] - state[SLOW_LOAD, j])
        friction = limits[FRICTION, j]
        held = min(abs(load[j] - state[SLOW_LOAD, j]), friction)
        limit = limits[REST, j] + held if moving[j] < RESTING else limits[MOVING, j]
        limit += changing * friction + ROUGHNESS * believed[j]
        state[DEVIATION, j], state[CHANGING, j], state[LIMIT, j] = deviation, changing, limit
        size = abs(deviation)
        ratio = size / limit
        state[BEGUN, j] = np.inf if ratio < BEGINNING else min(state[BEGUN, j], t)
        if present:
            state[PEAK, j] = max(state[PEAK, j], size)
            left = max(min(HELD * state[PEAK, j], limit + friction), RELEASED * state[PEAK, j])
            back &= size < max(OVER * limit, left)
            continue
        returns = ratio < 1.0 and t < scalars[RECOVERED]
        state[SLOW, j] += (1.0 - (quick if returns else slow)) * deviation
        if returns:
            state[BEGUN, j] = np.inf
        if ratio > first:
            second, begun_second = first, begun_first
            first, begun_first = ratio, state[BEGUN, j]
        elif ratio > second:
            second, begun_second = ratio, state[BEGUN, j]
    scalars[FOLLOWS] = 1.0
    sudden = first >= FIRST and second >= SECOND and abs(begun_first - begun_second) < TOGETHER
    scalars[LASTED] = scalars[LASTED] + dt if (back if present else sudden) else 0.0
    if scalars[LASTED] < DEBOUNCE:
        return
    scalars[PRESENT], scalars[LASTED] = 0.0 if present else 1.0, 0.0
    state[PEAK] = 0.0
    if present:
        scalars[ENDED], scalars[RECOVERED] = t, t + RECOVERY
