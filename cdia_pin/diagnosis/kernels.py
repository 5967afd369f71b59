r"""The arithmetic of a tick, compiled: residual, filtered columns, threshold, alarms, normal equations.

Discretised exactly for a torque held over the tick, E = exp(−γΔ), with a γ for each joint:

.. math:: r^+ = E r + (1-E)\,[\tfrac12(M^+ + M)(\dot q^+ - \dot q)/\Delta + \tfrac12(nle^+ + nle) - \tau]

.. math:: y^+ = E y + (1-E)\,\bar\varphi

with φ̄ the mean of both ends, or for effects of torque and acceleration the value over the interval.
Then r_j = c_jᵀ y_j + filtered η_j: joints do not mix.

All state is in one array that the caller owns, see `compiled`. Only this file and what is generated need numba;
it is imported when a monitor is first made.
"""

from __future__ import annotations

from collections import namedtuple

import numpy as np
from numba import njit

from cdia_pin.diagnosis.codes import ABSENT, ALARM

# What `JointEffect.columns` reads, here with arrays that run over the joints.
Signals = namedtuple("Signals", "q v a effort sign time")
# What `Unknown.columns` reads, here with arrays of shape (K, n) and (n,).
Neurons = namedtuple("Neurons", "position_centres velocity_centres position_width velocity_width")

# Rows of `joint`, each of shape (n,).
RESIDUAL, THRESHOLD, REMAINDER, EXCEEDED = 0, 1, 2, 3  # r, its bound, r − ĉᵀy, ticks beyond the bound
BOUND, SLOPE, WIDTH = 4, 5, 6  # η₀ = BOUND + SLOPE |M q̈ + nle|; speed over which sgn is smoothed
VELOCITY, NLE = 7, 8  # of the last tick
WATCHED, WEIGHT = 9, 10  # is the joint being decided upon, or how many ticks until then; samples collected
OUTSIDE = 11  # torque of model terms that are not of one joint, over the interval
LEARNING, LEARNED = 12, 13  # does the joint learn an unknown fault? what it has learned, filtered
AMPLITUDE = 14  # largest explained torque of late
MUTED = 16  # does nobody want to hear of an alarm?
POSITION, BANDWIDTH, ADDITION = 17, 18, 19  # q of the last tick, γ, what to add to a nominal torque
SOFT = 20  # speed over which sgn is smoothed where friction is compensated
REST = 21  # speed below which a joint may rest, and dry friction be anything
KNOWN_AMPLITUDE = 22  # largest torque of the model's own terms of late
MOVING = 15  # share of the filter's memory in which the joint moved: at rest dry friction can be anything
JOINT_ROWS = 23

# Rows of `columns`, each of shape (n, P).
PHI, FILTERED, BELIEVED, KNOWN = 0, 1, 2, 3  # φ of the last tick, y, ĉ, θ of the model's own terms
PRESENT = 4  # β of the effect's profile
COLUMN_ROWS = 5

# Rows of `neurons`, each of shape (n, 2 K + 1).
ACTIVATION, ACTIVATED, WEIGHTS = 0, 1, 2  # of the last tick, filtered, learned
NEURON_ROWS = 3

# Entries of `scalars`.
TIME, FORGET, REMEMBER, DEBOUNCE, IDLE, FLOOR, LEARNS, CORRECTS, DRIVEN, COUNT = range(10)
SCALARS = 10
SELDOM = 4  # ticks between two of the neurons, which take more time than all else

ROUGH = (
    0.2  # [1], share of a believed fault that its formula may miss for a moment, as friction's does at rest
)


@njit(cache=True)
def advance(
    joint, columns, gram, absent, mass, phi, interval, ends, q, v, tau, M, nle, a, E, forget, debounce, idle
):
    """Advance all joints by one tick; returns what needs attention."""
    n, P = phi.shape
    asks = 0
    for j in range(n):
        inertial = 0.0
        for i in range(n):
            inertial += 0.5 * (M[j, i] + mass[j, i]) * a[i]
        load = inertial + 0.5 * (nle[j] + joint[NLE, j])
        lacking = load - tau[j] - joint[OUTSIDE, j]
        explained = 0.0
        own = 0.0
        for k in range(P):
            mean = phi[j, k] if interval[k] else 0.5 * (phi[j, k] + columns[PHI, j, k])
            columns[PHI, j, k] = phi[j, k]
            own += columns[KNOWN, j, k] * mean
            y = E[j] * columns[FILTERED, j, k] + (1.0 - E[j]) * mean * columns[PRESENT, j, k]
            columns[FILTERED, j, k] = y
            explained += columns[BELIEVED, j, k] * y
        lacking -= own
        joint[KNOWN_AMPLITUDE, j] = max(abs(own), forget * joint[KNOWN_AMPLITUDE, j])
        r = E[j] * joint[RESIDUAL, j] + (1.0 - E[j]) * lacking
        joint[RESIDUAL, j] = r
        bound = joint[BOUND, j] + joint[SLOPE, j] * abs(load)
        threshold = E[j] * joint[THRESHOLD, j] + (1.0 - E[j]) * bound
        joint[THRESHOLD, j] = threshold
        remainder = r - explained - joint[LEARNED, j]
        joint[REMAINDER, j] = remainder
        explained = abs(r - remainder)
        joint[AMPLITUDE, j] = max(explained, forget * joint[AMPLITUDE, j])
        joint[MOVING, j] = E[j] * joint[MOVING, j] + (1.0 - E[j] if abs(v[j]) > joint[REST, j] else 0.0)
        resting = 1.0 - joint[MOVING, j]
        rough = (ROUGH + resting) * joint[AMPLITUDE, j] + resting * joint[KNOWN_AMPLITUDE, j]
        if abs(remainder) > threshold + rough:
            joint[EXCEEDED, j] += 1.0
            if joint[EXCEEDED, j] >= debounce and joint[MUTED, j] == 0.0:
                asks |= ALARM
        else:
            joint[EXCEEDED, j] = 0.0
        for e in range(len(ends) - 1):
            own = 0.0
            for k in range(ends[e], ends[e + 1]):
                own += columns[BELIEVED, j, k] * columns[FILTERED, j, k]
            if own == 0.0:
                continue
            # Without the effect the rest explains the residual, though the effect would be well visible.
            without = abs(remainder + own)
            if abs(own) > 2.0 * threshold and without < min(threshold + 0.1 * abs(own), 0.5 * abs(own)):
                absent[j, e] += 1.0
                if absent[j, e] >= idle:
                    asks |= ABSENT
            elif abs(own) > threshold and abs(remainder) < 0.5 * abs(own):
                absent[j, e] = 0.0
        joint[POSITION, j], joint[VELOCITY, j], joint[NLE, j] = q[j], v[j], nle[j]
        for i in range(n):
            mass[j, i] = M[j, i]
        if joint[WATCHED, j] < 0.0:
            joint[WATCHED, j] += 1.0
            if joint[WATCHED, j] == 0.0:
                joint[WATCHED, j] = 1.0
        elif joint[WATCHED, j] > 0.0 and joint[MOVING, j] > 0.9:
            accumulate(gram[j], columns[FILTERED, j], r, forget)
            joint[WEIGHT, j] = forget * joint[WEIGHT, j] + 1.0
    return asks


@njit(cache=True)
def accumulate(gram, y, r, forget):
    """Add a sample to the upper triangle of the forgetting Gram matrix of [y; r], shape (P + 1, P + 1)."""
    P = len(y)
    for i in range(P):
        for k in range(i, P):
            gram[i, k] = forget * gram[i, k] + y[i] * y[k]
        gram[i, P] = forget * gram[i, P] + y[i] * r
    gram[P, P] = forget * gram[P, P] + r * r


@njit(cache=True)
def activate(joint, neurons, activations, E):
    """Filter the neurons of the joints that learn; the last neuron is that of torque."""
    size, n = len(activations), joint.shape[1]
    for j in range(n):
        if joint[LEARNING, j] == 0.0:
            continue
        learned = 0.0
        for k in range(size):
            phi = activations[k][j]
            mean = phi if k == size - 1 else 0.5 * (phi + neurons[ACTIVATION, j, k])
            neurons[ACTIVATION, j, k] = phi
            y = E[j] * neurons[ACTIVATED, j, k] + (1.0 - E[j]) * mean
            neurons[ACTIVATED, j, k] = y
            learned += neurons[WEIGHTS, j, k] * y
        joint[LEARNED, j] = learned


@njit(cache=True)
def learn(joint, neurons, gram, forget):
    """Add the tick to the normal equations of the joints that learn."""
    for j in range(joint.shape[1]):
        if joint[LEARNING, j] > 0.0 and joint[WATCHED, j] >= 0.0:
            accumulate(gram[j], neurons[ACTIVATED, j], joint[RESIDUAL, j], forget)


@njit(cache=True)
def correction(joint, columns, neurons, activations, phi0, phi1, interval, smooth, tau, floor, divide):
    """Return the torque that makes up for what is believed and for the remainder, shape (n,).

    ``phi0`` holds the columns without torque, ``phi1`` those at the torque ``tau``. With ``divide`` the torque
    that replaces a nominal ``tau``, else what to add if ``tau`` acts already; then the columns of acceleration are
    the filtered ones, for nobody knows which acceleration is wanted.
    """
    n, P = phi0.shape
    out = np.empty(n)
    for j in range(n):
        state, driven = 0.0, 0.0
        for k in range(P):
            c = columns[BELIEVED, j, k] * columns[PRESENT, j, k]
            if c == 0.0:
                continue
            state += c * (phi0[j, k] if divide or not smooth[k] else columns[FILTERED, j, k])
            driven += c * (phi1[j, k] - phi0[j, k]) if interval[k] and not smooth[k] else 0.0
        if joint[LEARNING, j] > 0.0:
            for k in range(len(activations) - 1):
                state += neurons[WEIGHTS, j, k] * activations[k][j]
            driven += neurons[WEIGHTS, j, len(activations) - 1] * tau[j]
        wanted = tau[j] - state - joint[REMAINDER, j]
        if not divide:
            out[j] = -state - driven - joint[REMAINDER, j]
            continue
        gain = 1.0
        if driven != 0.0 and tau[j] != 0.0:
            gain = max(1.0 + driven / tau[j], floor)
        out[j] = wanted / gain
    return out
