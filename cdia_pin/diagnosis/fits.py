"""Least-squares fits of all combinations of effects to the normal equations of a joint, compiled."""

from __future__ import annotations

import numpy as np
from numba import njit

BOUND_SLACK = (
    0.3  # [1], share of the residual, in units of a parameter, by which noise may carry it past its bound
)
RIDGE = 1e-9  # added to the unit diagonal: keeps the factorisation of good columns from failing by rounding
LEAST_PIVOT = 1e-5  # pivot of unit columns, below which they are sums of each other on this motion
TINY = 1e-300  # keeps a column that was never excited from dividing by zero


@njit(cache=True)
def subsets(gram, ends, lower, upper, required, prior, centre, most, out_theta, out_rss, out_ok):
    """Fit every combination of effects that contains the required ones to the normal equations of a joint.

    Args:
        gram: Gram matrix of [y; r], upper triangle, shape (P + 1, P + 1).
        ends: Columns of the effects, shape (N + 1,).
        lower: Smallest parameters, shape (P,).
        upper: Largest parameters, shape (P,).
        required: Effects that every combination contains, one bit each.
        prior: Precision of the parameters that are believed already, beside the Gram matrix, shape (P,).
        centre: Parameters that are believed already, shape (P,).
        most: Largest number of effects besides the required ones.
        out_theta: Parameters of each combination; filled, shape (2^N, P).
        out_rss: Sum of squared residuals of each; filled, shape (2^N,).
        out_ok: Whether its fit exists and is physical; filled, shape (2^N,).
    """
    N = len(ends) - 1
    P = len(gram) - 1
    full = np.empty((P + 1, P + 1))
    for i in range(P + 1):
        for k in range(i, P + 1):
            full[i, k] = full[k, i] = gram[i, k]
    index = np.empty(P, np.int64)
    for mask in range(1 << N):
        out_ok[mask] = False
        out_rss[mask] = np.inf
        if (mask & required) != required:
            continue
        extra = mask & ~required
        count = 0
        while extra:
            extra &= extra - 1
            count += 1
        if count > most:
            continue
        p = 0
        for e in range(N):
            if mask >> e & 1:
                for k in range(ends[e], ends[e + 1]):
                    index[p] = k
                    p += 1
        theta, ok = solve(full, index, p, prior, centre)
        rss = full[P, P]
        for i in range(p):
            rss -= 2.0 * theta[i] * full[index[i], P]
            for k in range(p):
                rss += theta[i] * theta[k] * full[index[i], index[k]]
        for i in range(p):
            k = index[i]
            out_theta[mask, k] = theta[i]
            slack = np.sqrt(max(rss, 0.0) / max(full[k, k], TINY)) * BOUND_SLACK
            if theta[i] < lower[k] - slack or theta[i] > upper[k] + slack:
                ok = False
        out_rss[mask] = max(rss, 0.0)
        out_ok[mask] = ok


@njit(cache=True)
def solve(full, index, p, prior, centre):
    """Solve the normal equations of some columns by Cholesky; return the parameters, and whether it succeeded.

    Args:
        full: Gram matrix of [y; r], shape (P + 1, P + 1).
        index: The columns; the first p entries count.
        p: Number of columns.
        prior: Precision of the parameters that are believed already, shape (P,).
        centre: Parameters that are believed already, shape (P,).
    """
    theta = np.zeros(p)
    P = len(full) - 1
    L = np.zeros((p, p))
    scale = np.empty(p)
    for i in range(p):
        k = index[i]
        d = full[k, k] + prior[k]
        if d <= 0.0:
            return theta, False
        scale[i] = 1.0 / np.sqrt(d)
    for i in range(p):
        for k in range(i + 1):
            value = full[index[i], index[k]] * scale[i] * scale[k]
            if i == k:
                value += prior[index[i]] * scale[i] * scale[i] + RIDGE
            for m in range(k):
                value -= L[i, m] * L[k, m]
            if i == k:
                if value < LEAST_PIVOT:
                    return theta, False
                L[i, i] = np.sqrt(value)
            else:
                L[i, k] = value / L[k, k]
    for i in range(p):
        value = (full[index[i], P] + prior[index[i]] * centre[index[i]]) * scale[i]
        for m in range(i):
            value -= L[i, m] * theta[m]
        theta[i] = value / L[i, i]
    for i in range(p - 1, -1, -1):
        value = theta[i]
        for m in range(i + 1, p):
            value -= L[m, i] * theta[m]
        theta[i] = value / L[i, i]
    for i in range(p):
        theta[i] *= scale[i]
    return theta, True
