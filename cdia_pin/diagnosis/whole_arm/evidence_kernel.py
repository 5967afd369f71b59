"""The arithmetic of the evidence for effects of the whole arm, compiled: `evidence` says what it means."""

from __future__ import annotations

import numpy as np
from numba import njit

from cdia_pin.diagnosis.kernels import MOVING_SHARE, accumulate

SETTLED = 2.0  # [1], time constants until the start of a filter is forgotten, which is the present columns


@njit(cache=True)
def add(gram, weight, row, phi, last_phi, filtered, remainder, moving, bandwidth, age, dt, keep):
    """Add a sample of the joints that move, once their filters have settled.

    Args:
        gram: Gram matrices of [y z; r], upper triangles, shape (n, P + A + 1, P + A + 1).
        weight: Durations of the samples in them [s], shape (n,).
        row: [y z; r] of the last sample; that of this one is filled in, shape (n, P + A + 1).
        phi: Columns of the whole arm's effects now, shape (n, A).
        last_phi: The same at the last sample, shape (n, A).
        filtered: Filtered columns of the joints' effects, shape (n, P) or wider.
        remainder: Residual less the torque of what is believed [N·m or N], shape (n,).
        moving: Share of the filter's memory in which each joint moved [1], shape (n,).
        bandwidth: γ [1/s], shape (n,).
        age: Time since samples are collected [s].
        dt: Time since the last sample [s]; 0 at the first one, whose columns are those now.
        keep: Weight that old samples keep [1].
    """
    n, A = phi.shape
    size = row.shape[1]
    P = size - 1 - A
    for j in range(n):
        E = np.exp(-bandwidth[j] * dt)
        for k in range(A):
            mean = 0.5 * (phi[j, k] + last_phi[j, k])
            row[j, P + k] = E * row[j, P + k] + (1.0 - E) * mean if dt > 0.0 else phi[j, k]
        for k in range(P):
            row[j, k] = filtered[j, k]
        row[j, size - 1] = remainder[j]
        if moving[j] > MOVING_SHARE and age > SETTLED / bandwidth[j]:
            accumulate(gram[j], row[j, : size - 1], remainder[j], keep, dt)
            weight[j] = keep * weight[j] + dt


@njit(cache=True)
def columns(bodies, gravity, on_regressors, used):
    """Return [Y K] A, the torque per unit of each parameter of the whole arm's effects, shape (n, A).

    Args:
        bodies: Y, shape (n, 10 n).
        gravity: K, shape (n, 3).
        on_regressors: A, shape (10 n + 3, A).
        used: Rows of A that are not zero.
    """
    n, split = bodies.shape
    A = on_regressors.shape[1]
    out = np.zeros((n, A))
    for i in used:
        for j in range(n):
            entry = bodies[j, i] if i < split else gravity[j, i - split]
            for k in range(A):
                out[j, k] += entry * on_regressors[i, k]
    return out
