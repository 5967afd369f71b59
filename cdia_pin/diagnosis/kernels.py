r"""The arithmetic of a tick, compiled: residual, filtered columns, threshold, alarms, normal equations.

Discretised exactly for a torque held over the tick, E = exp(−γΔ), with a γ for each joint:

.. math:: r^+ = E r + (1-E)\,[\tfrac12(M^+ + M)(\dot q^+ - \dot q)/\Delta + \tfrac12(nle^+ + nle) - \tau]

.. math:: y^+ = E y + (1-E)\,\bar\varphi

φ̄ is the mean of φ at both ends, or, for effects of torque and acceleration, the value over the interval.
Then r_j = c_jᵀ y_j + filtered η_j: joints do not mix.

The threshold depends on the state as that of [Thesis] does: one bound while a joint moves, another one near its rest,
where a model of friction errs most, and a wider one at speeds that no healthy run has had.

All state is in one array that the caller owns, see `layout`; `kernel_rows` names its rows. This module, `fits` and the
generated modules are the only ones that need numba. They are imported when a monitor is first made.
"""

from __future__ import annotations

from collections import namedtuple

from numba import njit

from cdia_pin.diagnosis.kernel_rows import (
    ACTIVATED,
    ACTIVATION,
    AMPLITUDE,
    BELIEVED,
    BOUND,
    COLLECTING,
    EXCEEDED,
    FILTERED,
    HIGHEST_VELOCITY,
    KNOWN,
    KNOWN_AMPLITUDE,
    LEARNED,
    LEARNING,
    LOWEST_VELOCITY,
    MOVING,
    MUTED,
    NLE,
    OUTSIDE,
    PHI,
    POSITION,
    PRESENT,
    REMAINDER,
    RESIDUAL,
    REST_BOUND,
    REST_SPEED,
    STEADY,
    THRESHOLD,
    VELOCITY,
    WEIGHT,
    WEIGHTS,
)
from cdia_pin.diagnosis.tick_flags import ABSENT, ALARM

# What `JointEffect.columns` reads, here with arrays over the joints, shape (n,), or with the numbers of one.
Signals = namedtuple("Signals", "q v a effort sign time")
# What `Unknown.columns` reads, here of one joint: arrays of shape (K,), and numbers.
Neurons = namedtuple(
    "Neurons", "position_centres velocity_centres damping_centres position_width velocity_width"
)

NEURON_PERIOD = 4  # ticks between two evaluations of the neurons, which cost more than the rest of the tick
ROUGHNESS = 0.2  # [1], share of a believed effect that its formula may miss, as those of friction at rest and of loads
VISIBLE = 2.0  # [1], torque of an effect over the threshold, from which its absence would show
GONE_SHARE = (
    0.1  # [1], share of an absent effect's torque by which the residual may be off beside the threshold
)
EXPLAINED_SHARE = 0.5  # [1], remainder over an effect's torque, below which the effect explains the residual
MOVING_SHARE = (
    0.9  # [1], least share of the filter's memory in motion, for a sample to be used for a decision
)
STEADY_SHARE = 0.95  # [1], the same, for a sample to show what is small but lasts


@njit(cache=True)
def advance(
    joint,
    columns,
    gram,
    absent,
    mass,
    phi,
    interval,
    ends,
    q,
    v,
    tau,
    M,
    nle,
    a,
    E,
    forget,
    debounce,
    absent_ticks,
):
    """Advance all joints by one tick; return what needs attention, see `tick_flags`.

    Args:
        joint: Part of the state, shape (rows, n).
        columns: Part of the state, shape (rows, n, P).
        gram: Gram matrices of [y; r], upper triangles, shape (n, P + 1, P + 1).
        absent: Ticks for which an effect's torque has stayed away, shape (n, N).
        mass: M of the last tick, shape (n, n).
        phi: Columns of this tick, shape (n, P).
        interval: Which columns hold over the interval instead of at its end, shape (P,).
        ends: First column of each effect, and P, shape (N + 1,).
        q: Positions [rad or m], shape (n,).
        v: Velocities [rad/s or m/s], shape (n,).
        tau: Torque since the last tick [N·m or N], shape (n,).
        M: Mass matrix at q, shape (n, n).
        nle: Coriolis, centrifugal and gravity torque [N·m or N], shape (n,).
        a: Mean acceleration since the last tick [rad/s² or m/s²], shape (n,).
        E: exp(−γΔ) [1], shape (n,).
        forget: Weight that a sample keeps from tick to tick [1].
        debounce: Ticks in a row beyond the threshold that raise an alarm.
        absent_ticks: Ticks without an effect's torque, where it would show, that report it as absent.
    """
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
        joint[MOVING, j] = E[j] * joint[MOVING, j] + (1.0 - E[j] if abs(v[j]) > joint[REST_SPEED, j] else 0.0)
        resting = 1.0 - joint[MOVING, j]
        near = min(resting / (1.0 - MOVING_SHARE), 1.0)
        bound = joint[BOUND, j] + near * (joint[REST_BOUND, j] - joint[BOUND, j])
        beyond = max(v[j] - joint[HIGHEST_VELOCITY, j], joint[LOWEST_VELOCITY, j] - v[j])
        if beyond > 0.0:
            fastest = max(joint[HIGHEST_VELOCITY, j], -joint[LOWEST_VELOCITY, j], joint[REST_SPEED, j])
            bound = joint[REST_BOUND, j] * (1.0 + beyond / fastest)
        joint[STEADY, j] = 1.0 if joint[MOVING, j] > STEADY_SHARE and beyond <= 0.0 else 0.0
        threshold = E[j] * joint[THRESHOLD, j] + (1.0 - E[j]) * bound
        joint[THRESHOLD, j] = threshold
        remainder = r - explained - joint[LEARNED, j]
        joint[REMAINDER, j] = remainder
        explained = abs(r - remainder)
        joint[AMPLITUDE, j] = max(explained, forget * joint[AMPLITUDE, j])
        rough = (ROUGHNESS + resting) * joint[AMPLITUDE, j] + resting * joint[KNOWN_AMPLITUDE, j]
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
            if abs(own) > VISIBLE * threshold and without < min(
                threshold + GONE_SHARE * abs(own), EXPLAINED_SHARE * abs(own)
            ):
                absent[j, e] += 1.0
                if absent[j, e] >= absent_ticks:
                    asks |= ABSENT
            elif abs(own) > threshold and abs(remainder) < EXPLAINED_SHARE * abs(own):
                absent[j, e] = 0.0
        joint[POSITION, j], joint[VELOCITY, j], joint[NLE, j] = q[j], v[j], nle[j]
        for i in range(n):
            mass[j, i] = M[j, i]
        if joint[COLLECTING, j] < 0.0:
            joint[COLLECTING, j] += 1.0
            if joint[COLLECTING, j] == 0.0:
                joint[COLLECTING, j] = 1.0
        elif joint[COLLECTING, j] > 0.0 and joint[MOVING, j] > MOVING_SHARE:
            accumulate(gram[j], columns[FILTERED, j], r, forget, 1.0)
            joint[WEIGHT, j] = forget * joint[WEIGHT, j] + 1.0
    return asks


@njit(cache=True)
def accumulate(gram, y, r, forget, worth):
    """Add a sample to the upper triangle of the Gram matrix of [y; r], and discount the old ones.

    Args:
        gram: The Gram matrix, shape (P + 1, P + 1).
        y: Filtered columns, shape (P,).
        r: Residual [N·m or N].
        forget: Weight that old samples keep [1].
        worth: Weight of this one [1], or the time that it stands for [s].
    """
    P = len(y)
    for i in range(P):
        own = worth * y[i]
        for k in range(i, P):
            gram[i, k] = forget * gram[i, k] + own * y[k]
        gram[i, P] = forget * gram[i, P] + own * r
    gram[P, P] = forget * gram[P, P] + worth * r * r


@njit(cache=True)
def refresh(joint, columns, neurons, j):
    """Compute the remainder of a joint again, after what is believed of it has changed.

    Args:
        joint: Part of the state, shape (rows, n).
        columns: Part of the state, shape (rows, n, P).
        neurons: Part of the state, shape (rows, n, H).
        j: The joint's index.
    """
    learned, explained = 0.0, 0.0
    for k in range(neurons.shape[2]):
        learned += neurons[WEIGHTS, j, k] * neurons[ACTIVATED, j, k]
    for k in range(columns.shape[2]):
        explained += columns[BELIEVED, j, k] * columns[FILTERED, j, k]
    joint[LEARNED, j] = learned
    joint[REMAINDER, j] = joint[RESIDUAL, j] - explained - learned


@njit(cache=True)
def believes_in(columns, chosen):
    """Return whether an effect with one of the chosen columns is believed in, on any joint.

    Args:
        columns: Part of the state, shape (rows, n, P).
        chosen: The columns, shape (P,).
    """
    for j in range(columns.shape[1]):
        for k in range(columns.shape[2]):
            if chosen[k] and columns[BELIEVED, j, k] != 0.0:
                return True
    return False


@njit(cache=True)
def activate(joint, neurons, activations, E):
    """Filter the neurons of the joints that learn; the last neuron is that of torque.

    Args:
        joint: Part of the state, shape (rows, n).
        neurons: Part of the state, shape (rows, n, H).
        activations: Of the joints that learn, shape (n, H).
        E: exp(−γΔ) over the ticks since the last call [1], shape (n,).
    """
    n, size = activations.shape
    for j in range(n):
        if joint[LEARNING, j] == 0.0:
            continue
        learned = 0.0
        for k in range(size):
            phi = activations[j, k]
            mean = phi if k == size - 1 else 0.5 * (phi + neurons[ACTIVATION, j, k])
            neurons[ACTIVATION, j, k] = phi
            y = E[j] * neurons[ACTIVATED, j, k] + (1.0 - E[j]) * mean
            neurons[ACTIVATED, j, k] = y
            learned += neurons[WEIGHTS, j, k] * y
        joint[LEARNED, j] = learned


@njit(cache=True)
def learn(joint, neurons, gram, forget):
    """Add the tick to the normal equations of the joints that learn.

    Args:
        joint: Part of the state, shape (rows, n).
        neurons: Part of the state, shape (rows, n, H).
        gram: Gram matrices of the neurons and the residual, upper triangles, shape (n, H + 1, H + 1).
        forget: Weight that old samples keep [1].
    """
    for j in range(joint.shape[1]):
        if joint[LEARNING, j] > 0.0 and joint[COLLECTING, j] >= 0.0:
            accumulate(gram[j], neurons[ACTIVATED, j], joint[RESIDUAL, j], forget, 1.0)


@njit(cache=True)
def correction(
    joint, columns, neurons, activations, unloaded, loaded, interval, smooth, tau, floor, divide, out
):
    """Fill in the torque that compensates the believed faults and the remainder.

    With ``divide`` it is the torque that replaces a nominal ``tau``. Without, it is what to add if ``tau`` acts
    already; columns of acceleration are then the filtered ones, because the wanted acceleration is not known.

    Args:
        joint: Part of the state, shape (rows, n).
        columns: Part of the state, shape (rows, n, P).
        neurons: Part of the state, shape (rows, n, H).
        activations: Of the joints that learn, zero where weights are, shape (n, H).
        unloaded: Columns without torque, shape (n, P).
        loaded: Columns at the torque ``tau``, shape (n, P).
        interval: Which columns depend on torque or acceleration, shape (P,).
        smooth: Which columns depend on acceleration, shape (P,).
        tau: Nominal torque, or the torque that acts [N·m or N], shape (n,).
        floor: Least 1 + h that a torque is divided by [1].
        divide: Whether the torque replaces a nominal one.
        out: The torque; filled [N·m or N], shape (n,).
    """
    n, P = unloaded.shape
    for j in range(n):
        state, driven = 0.0, 0.0
        for k in range(P):
            c = columns[BELIEVED, j, k] * columns[PRESENT, j, k]
            if c == 0.0:
                continue
            state += c * (unloaded[j, k] if divide or not smooth[k] else columns[FILTERED, j, k])
            driven += c * (loaded[j, k] - unloaded[j, k]) if interval[k] and not smooth[k] else 0.0
        if joint[LEARNING, j] > 0.0:
            size = activations.shape[1]
            for k in range(size - 1):
                state += neurons[WEIGHTS, j, k] * activations[j, k]
            driven += neurons[WEIGHTS, j, size - 1] * tau[j]
        wanted = tau[j] - state - joint[REMAINDER, j]
        if not divide:
            out[j] = -state - driven - joint[REMAINDER, j]
            continue
        gain = 1.0
        if driven != 0.0 and tau[j] != 0.0:
            gain = max(1.0 + driven / tau[j], floor)
        out[j] = wanted / gain
