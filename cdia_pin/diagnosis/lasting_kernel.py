"""The arithmetic of the second detector, compiled: `lasting` says what it means."""

from __future__ import annotations

import numpy as np
from numba import njit

from cdia_pin.diagnosis.kernels import ROUGHNESS, accumulate
from cdia_pin.diagnosis.ridge_kernel import ridge_solve

# On motions unlike the healthy runs, models of measured arms were up to 0.13 of the torque off.
LEAST_SHARE = 0.15  # least limit over the joint's RMS torque, in the healthy runs and of late [1]


@njit(cache=True)
def add(gram, energy, weight, columns, remainder, torque, counts, dt, keep):
    """Add a sample of the joints that move.

    Args:
        gram: Gram matrices of the columns and the remainder, upper triangles, shape (n, P + 1, P + 1).
        energy: Integrals of the squared torque [(N·m)² s or N² s], shape (n,).
        weight: Durations of the motion seen [s], shape (n,).
        columns: Filtered columns of the effects, shape (n, P) or wider.
        remainder: Residual less the torque of what is believed [N·m or N], shape (n,).
        torque: Measured torque [N·m or N], shape (n,).
        counts: Which joints move, shape (n,).
        dt: Time since the last sample [s].
        keep: Weight that old samples keep [1].
    """
    P = gram.shape[1] - 1
    for j in range(len(gram)):
        if counts[j]:
            accumulate(gram[j], columns[j, :P], remainder[j], keep, dt)
            energy[j] = keep * energy[j] + dt * torque[j] ** 2
            weight[j] = keep * weight[j] + dt


@njit(cache=True)
def beyond(explained, limit, energy, weight, believed):
    """Return the joints on which an effect explains more than a healthy arm shows, shape (n,).

    Args:
        explained: RMS torque that each effect explains [N·m or N], shape (n, N).
        limit: The same of a healthy arm, shape (n, N).
        energy: Integrals of the squared torque [(N·m)² s or N² s], shape (n,).
        weight: Durations of the motion seen [s], shape (n,).
        believed: Largest torque of late of what is believed [N·m or N], shape (n,). Its formula may miss a share.
    """
    n, N = explained.shape
    out = np.zeros(n, np.bool_)
    for j in range(n):
        least = LEAST_SHARE * np.sqrt(energy[j] / weight[j]) if weight[j] > 0.0 else 0.0
        for e in range(N):
            if explained[j, e] > max(limit[j, e], least) + ROUGHNESS * believed[j]:
                out[j] = True
    return out


@njit(cache=True, error_model="numpy")
def explained(gram, weight, ends, least):
    """Return the RMS torque that each effect explains [N·m or N], zero without enough motion, shape (n, N).

    Args:
        gram: Gram matrices of the columns and the remainder, upper triangles, shape (n, P + 1, P + 1).
        weight: Durations of the motion seen [s], shape (n,).
        ends: First column of each effect, and P, shape (N + 1,).
        least: Duration of motion from which it counts [s].
    """
    n, N = len(gram), len(ends) - 1
    out = np.zeros((n, N))
    for j in range(n):
        if weight[j] < least:
            continue
        for e in range(N):
            first, end = ends[e], ends[e + 1]
            right = gram[j, first:end, -1]
            theta, gain = ridge_solve(gram[j, first:end, first:end], right), 0.0
            for k in range(end - first):
                gain += theta[k] * right[k]
            out[j, e] = np.sqrt(max(gain, 0.0) / weight[j])
    return out
