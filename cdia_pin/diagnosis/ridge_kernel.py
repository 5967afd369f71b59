"""Least squares with a ridge, compiled: `joint_gram.ridge_inverse` for the few columns of one effect."""

from __future__ import annotations

import numpy as np
from numba import njit

from cdia_pin.diagnosis.joint_gram import RIDGE, TINY


@njit(cache=True, error_model="numpy")
def ridge_solve(gram, right):
    """Return θ of normal equations that are scaled to a unit diagonal with a ridge, in their own units, shape (p,).

    Columns may repeat each other, or may not have been excited at all; neither fails.

    Args:
        gram: Normal equations, of which the upper triangle counts, shape (p, p).
        right: Their right side, shape (p,).
    """
    p = len(right)
    L, unit, theta = np.empty((p, p)), np.empty(p), np.empty(p)
    for i in range(p):
        unit[i] = 1.0 / np.sqrt(gram[i, i]) if gram[i, i] > TINY else 1.0
    for i in range(p):
        for k in range(i + 1):
            value = gram[k, i] * unit[k] * unit[i]
            for m in range(k):
                value -= L[i, m] * L[k, m]
            L[i, k] = np.sqrt(value + RIDGE) if i == k else value / L[k, k]
        value = right[i] * unit[i]
        for m in range(i):
            value -= L[i, m] * theta[m]
        theta[i] = value / L[i, i]
    for i in range(p - 1, -1, -1):
        for m in range(i + 1, p):
            theta[i] -= L[m, i] * theta[m]
        theta[i] /= L[i, i]
    for i in range(p):
        theta[i] *= unit[i]
    return theta
