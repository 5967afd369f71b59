"""The check of a sample against the one before, compiled: a healthy tick costs it one or two microseconds.

All state is in arrays that the caller owns. `LOWER` and the like are rows of `bounds`, `POSITIONS` and the like rows of
`state`, both of shape (rows, n); `PREVIOUS` and the like are entries of `scalars`.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from cdia_pin.diagnosis.sample_codes import (
    DISAGREE,
    FROZEN,
    GAP,
    GOOD,
    JUMP,
    LATEST,
    OUTSIDE,
    POSITION,
    TIME_BACK,
    TIME_IMPOSSIBLE,
    TIME_TWICE,
    TORQUE,
    VELOCITY,
    ZEROED,
)
from cdia_pin.diagnosis.sample_rows import (
    ACCELERATION,
    ACCEPTED,
    ACCEPTED_POSITION,
    ACCEPTED_TORQUE,
    ACCEPTED_VELOCITY,
    ACCUSED,
    DRIFT,
    DRIFT_BOUND,
    ERROR,
    FASTEST,
    HAS_VELOCITY,
    HELD_ERROR,
    HELD_POSITION,
    HELD_TORQUE,
    HELD_TRAVEL,
    HELD_VELOCITY,
    HOLD_TORQUE,
    HOLD_VELOCITY,
    IS_GOOD,
    JOINT,
    LONGEST,
    LOWER,
    MEMORY,
    NOISY_AT_REST,
    PERIOD,
    POSITION_SLACK,
    PREVIOUS,
    PREVIOUS_POSITION,
    PREVIOUS_TORQUE,
    PREVIOUS_VELOCITY,
    REST_SPEED,
    SATURATED,
    SHORTEST,
    STRONGEST,
    TORQUE_SLACK,
    TORQUE_STEP,
    TRAVEL_BOUND,
    TRAVELLED,
    UPPER,
    VELOCITY_SLACK,
    VELOCITY_STEP,
    ZERO_TORQUE,
    ZERO_VELOCITY,
)

BEGINNING = (
    10  # samples of a run that teach nothing: a controller starts, and the first torques may not be known
)
INERTIAL_SHARE = (
    1.0 / 12.0
)  # [1], of a Δ²: distance from the mean of both velocities if the acceleration grows from 0 to a


@njit(cache=True)
def step_between(bounds, state, scalars, q0, v0, tau0, q, v, tau, dt):
    """Return why a sample cannot follow another one, or `GOOD`; notes the steps and the joint.

    Args:
        bounds: What an arm can do, shape (rows, n).
        state: State of the check, shape (rows, n).
        scalars: Its numbers.
        q0: Positions of the other sample [rad or m], shape (n,).
        v0: Its velocities [rad/s or m/s], shape (n,).
        tau0: Its torques [N·m or N], shape (n,).
        q: Positions [rad or m], shape (n,).
        v: Velocities [rad/s or m/s], shape (n,).
        tau: Torques [N·m or N], shape (n,).
        dt: Time between the two [s], above 0.
    """
    n = len(q)
    late = max(1.0, dt / scalars[PERIOD])
    code = GOOD
    # The clock may be off, and not the arm; an interval of nearly two ticks may be one.
    ticks = np.rint(dt / scalars[PERIOD]) if dt > 1.9 * scalars[PERIOD] else 1.0
    uneven = abs(dt - ticks * scalars[PERIOD])
    measured = scalars[HAS_VELOCITY] > 0.0
    moved_q = moved_v = moved_tau = False
    zeros_q = zeros_v = zeros_tau = 0
    for j in range(n):
        speed = v[j] if measured else (q[j] - q0[j]) / dt
        step = speed - v0[j]
        reach = bounds[ACCELERATION, j] * dt
        error = q[j] - q0[j] - 0.5 * (speed + v0[j]) * dt if measured else 0.0
        torque = tau[j] - tau0[j]
        state[VELOCITY_STEP, j], state[ERROR, j], state[TORQUE_STEP, j] = step, error, torque
        if code == GOOD or code == JUMP + TORQUE:
            slack = bounds[POSITION_SLACK, j] * late + INERTIAL_SHARE * reach * dt
            if abs(error) > slack + 0.5 * abs(speed + v0[j]) * uneven:
                code = JUMP + POSITION
                scalars[JOINT] = j
            elif abs(step) > bounds[VELOCITY_SLACK, j] + reach:
                code = JUMP + VELOCITY if measured else JUMP + POSITION
                scalars[JOINT] = j
            elif code == GOOD and abs(torque) > bounds[TORQUE_SLACK, j] * late:
                code = JUMP + TORQUE
                scalars[JOINT] = j
        zeros_q += q[j] == 0.0
        zeros_v += v[j] == 0.0
        zeros_tau += tau[j] == 0.0
        moved_q |= abs(q0[j]) > bounds[POSITION_SLACK, j]
        moved_v |= abs(v0[j]) > bounds[ZERO_VELOCITY, j]
        moved_tau |= abs(tau0[j]) > bounds[ZERO_TORQUE, j]
    if code == GOOD and n > 1:
        if zeros_q == n and moved_q:
            code = ZEROED + POSITION
        elif measured and zeros_v == n and moved_v:
            code = ZEROED + VELOCITY
        elif zeros_tau == n and moved_tau:
            code = ZEROED + TORQUE
    return code


@njit(cache=True)
def judge(bounds, state, scalars, q, v, tau, t):
    """Compare a sample with the one before, whatever that was; return why it cannot be, or `GOOD`.

    Args:
        bounds: What an arm can do, shape (rows, n).
        state: State of the check, shape (rows, n).
        scalars: Its numbers.
        q: Positions [rad or m], shape (n,).
        v: Velocities [rad/s or m/s], shape (n,); zeros where they are not measured.
        tau: Torques [N·m or N], shape (n,).
        t: Time [s].
    """
    n = len(q)
    code = GOOD
    if not abs(t) <= LATEST:
        code = TIME_IMPOSSIBLE
    else:
        for j in range(n):
            if not (bounds[LOWER, j] <= q[j] <= bounds[UPPER, j]):
                code = OUTSIDE + POSITION
            elif not abs(v[j]) <= bounds[FASTEST, j]:
                code = OUTSIDE + VELOCITY
            elif not abs(tau[j]) <= bounds[STRONGEST, j]:
                code = OUTSIDE + TORQUE
            if code != GOOD:
                scalars[JOINT] = j
                break
    dt = t - scalars[PREVIOUS]
    if code == GOOD and not dt >= 0.0:
        code = TIME_BACK
    elif code == GOOD and dt < scalars[SHORTEST]:
        code = TIME_TWICE
    if code != GOOD and scalars[IS_GOOD] > 0.0:
        keep(state, scalars)
    if code not in (GOOD, TIME_BACK):
        return code  # this sample is no reference for the next one
    measured = scalars[HAS_VELOCITY] > 0.0
    if code == GOOD and dt > scalars[LONGEST]:
        code = GAP if scalars[PREVIOUS] > -np.inf else GOOD
        if code == GAP and scalars[IS_GOOD] > 0.0:
            keep(state, scalars)
        begins = True
    else:
        begins = code == TIME_BACK
    if begins:
        for j in range(n):
            state[PREVIOUS_POSITION, j], state[PREVIOUS_TORQUE, j] = q[j], tau[j]
            state[PREVIOUS_VELOCITY, j] = v[j] if measured else np.nan
            state[HELD_POSITION, j] = state[HELD_VELOCITY, j] = state[HELD_TORQUE, j] = 0.0
        scalars[PREVIOUS] = t
        return code
    code = step_between(
        bounds,
        state,
        scalars,
        state[PREVIOUS_POSITION],
        state[PREVIOUS_VELOCITY],
        state[PREVIOUS_TORQUE],
        q,
        v,
        tau,
        dt,
    )
    late = max(1.0, dt / scalars[PERIOD])
    accused = GOOD
    for j in range(n):
        fade = 1.0 - min(1.0, dt / scalars[MEMORY])
        speed = v[j] if measured else (q[j] - state[PREVIOUS_POSITION, j]) / dt
        mean = 0.5 * (speed + state[PREVIOUS_VELOCITY, j])
        # A single jump says nothing about the time after it, so that it counts no more than the largest usual error.
        most = bounds[POSITION_SLACK, j] * late + INERTIAL_SHARE * bounds[ACCELERATION, j] * dt * dt
        error = min(max(state[ERROR, j], -most), most)
        still = q[j] == state[PREVIOUS_POSITION, j]
        state[HELD_POSITION, j] = state[HELD_POSITION, j] + 1.0 if still else 0.0
        state[HELD_TRAVEL, j] = fade * state[HELD_TRAVEL, j] + mean * dt if still and measured else 0.0
        held = measured and v[j] == state[PREVIOUS_VELOCITY, j]
        state[HELD_VELOCITY, j] = state[HELD_VELOCITY, j] + 1.0 if held else 0.0
        state[HELD_ERROR, j] = fade * state[HELD_ERROR, j] + error if held else 0.0
        constant = tau[j] == state[PREVIOUS_TORQUE, j]
        state[HELD_TORQUE, j] = state[HELD_TORQUE, j] + 1.0 if constant else 0.0
        state[DRIFT, j] = fade * state[DRIFT, j] + error
        why = GOOD
        if abs(state[HELD_TRAVEL, j]) > bounds[TRAVEL_BOUND, j]:
            why = FROZEN + (VELOCITY if state[HELD_VELOCITY, j] >= state[HELD_POSITION, j] else POSITION)
        elif state[HELD_VELOCITY, j] > bounds[HOLD_VELOCITY, j] and (
            abs(state[HELD_ERROR, j]) > bounds[TRAVEL_BOUND, j] or bounds[NOISY_AT_REST, j] > 0.0
        ):
            why = FROZEN + VELOCITY
        elif (
            state[HELD_TORQUE, j] > bounds[HOLD_TORQUE, j]
            and abs(speed) > bounds[REST_SPEED, j]
            and abs(tau[j]) < bounds[SATURATED, j]
        ):
            why = FROZEN + TORQUE
        elif abs(state[DRIFT, j]) > bounds[DRIFT_BOUND, j]:
            why = DISAGREE
        state[ACCUSED, j] = why
        if why != GOOD and accused == GOOD:
            accused = why
            scalars[JOINT] = j
    if accused != GOOD:
        code = accused
    if code != GOOD and scalars[IS_GOOD] > 0.0:
        keep(state, scalars)
    for j in range(n):
        speed = v[j] if measured else (q[j] - state[PREVIOUS_POSITION, j]) / dt
        usual = measured or code == GOOD
        state[TRAVELLED, j] += 0.5 * (speed + state[PREVIOUS_VELOCITY, j]) * dt if usual else 0.0
        state[PREVIOUS_POSITION, j], state[PREVIOUS_VELOCITY, j] = q[j], speed
        state[PREVIOUS_TORQUE, j] = tau[j]
    scalars[PREVIOUS] = t
    return code


@njit(cache=True)
def keep(state, scalars):
    """Keep the last good sample, before others take its place.

    Args:
        state: State of the check, shape (rows, n).
        scalars: Its numbers.
    """
    for j in range(state.shape[1]):
        state[ACCEPTED_POSITION, j] = state[PREVIOUS_POSITION, j]
        state[ACCEPTED_VELOCITY, j] = state[PREVIOUS_VELOCITY, j]
        state[ACCEPTED_TORQUE, j] = state[PREVIOUS_TORQUE, j]
        state[TRAVELLED, j] = 0.0
    scalars[ACCEPTED] = scalars[PREVIOUS]
    scalars[IS_GOOD] = 0.0


@njit(cache=True)
def since_good(bounds, state, scalars, q, v, tau, t):
    """Return why a sample cannot follow the last good one, or `GOOD`.

    Args:
        bounds: What an arm can do, shape (rows, n).
        state: State of the check, shape (rows, n).
        scalars: Its numbers.
        q: Positions [rad or m], shape (n,).
        v: Velocities [rad/s or m/s], shape (n,); zeros where they are not measured.
        tau: Torques [N·m or N], shape (n,).
        t: Time [s].
    """
    dt = t - scalars[ACCEPTED]
    if not dt >= scalars[SHORTEST]:
        return TIME_BACK
    if dt > scalars[LONGEST]:
        return GAP
    return step_between(
        bounds,
        state,
        scalars,
        state[ACCEPTED_POSITION],
        state[ACCEPTED_VELOCITY],
        state[ACCEPTED_TORQUE],
        q,
        v,
        tau,
        dt,
    )


@njit(cache=True)
def survey(bounds, state, scalars, time, q, v, tau, watched, largest):
    """Raise `largest` to the largest size that each watched row of the state takes along a run, shape (rows, n).

    Args:
        bounds: Infinite ones, so that every sample passes, shape (rows, n).
        state: State of the check, shape (rows, n).
        scalars: Its numbers.
        time: Times [s], shape (K,).
        q: Positions [rad or m], shape (K, n).
        v: Velocities [rad/s or m/s], shape (K, n).
        tau: Torques [N·m or N], shape (K, n).
        watched: Rows of the state, shape (R,).
        largest: Largest sizes, in the order of `watched`, shape (R, n).
    """
    for k in range(len(time)):
        code = judge(bounds, state, scalars, q[k], v[k], tau[k], time[k])
        if k < BEGINNING or code != GOOD:
            continue
        for i in range(len(watched)):
            for j in range(q.shape[1]):
                size = abs(state[watched[i], j])
                largest[i, j] = max(largest[i, j], size)
