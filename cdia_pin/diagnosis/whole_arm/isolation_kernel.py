"""Fits of effects of the whole arm, and of the joints' own beside them, compiled: `isolation` says what they mean."""

from __future__ import annotations

import numpy as np
from numba import njit

from cdia_pin.diagnosis.ridge_kernel import ridge_solve

# [1], share of the remainder that a formula may miss where noise is small: the arm's own masses are a few per cent
# wrong, and the joints' formulas fit as closely for a second or two
MISSED = 0.1
COINCIDENCE = 9.0  # [1], log-odds against a joint that fails within seconds of another one: 10⁻⁴
UNUSUAL = 5.0  # [1], log-odds against an effect that arms in use hardly ever have
LEAST_WEIGHT = 0.2  # [s] of motion of a joint, from which it counts
TINY = 1e-300  # keeps a column that was never excited from dividing by zero


@njit(cache=True, error_model="numpy")
def units(gram, weight, level, independent):
    """Return what a gain of log-likelihood of one is worth on each joint [(N·m)² s], shape (n,); 0 without motion.

    Args:
        gram: Gram matrices of [y z; r], upper triangles, shape (n, P + A + 1, P + A + 1).
        weight: Durations of the samples in them [s], shape (n,).
        level: RMS of a healthy residual [N·m or N], shape (n,).
        independent: Time for which it stays alike [s], shape (n,).
    """
    out, total, count = np.zeros(len(gram)), 0.0, 0
    for j in range(len(gram)):
        if weight[j] >= LEAST_WEIGHT:
            total += gram[j, -1, -1] / weight[j] / level[j] ** 2
            count += 1
    for j in range(len(gram)):
        if weight[j] >= LEAST_WEIGHT:
            healthy2 = level[j] ** 2
            most = max(gram[j, -1, -1] / weight[j], healthy2 * total / count)
            out[j] = 2.0 * (healthy2 + MISSED**2 * most) * independent[j]
    return out


@njit(cache=True, error_model="numpy")
def of_joints(gram, unit, alarmed, ends, price):
    """Return what the best single effects of some joints gain, penalties included, and the least share they explain.

    Each of these joints has left its threshold, so it must have a cause, even if that gains less than its penalty.

    Args:
        gram: Gram matrices of [y z; r], upper triangles, shape (n, P + A + 1, P + A + 1).
        unit: Of a gain of log-likelihood [(N·m)² s], 0 for a joint that does not count, shape (n,).
        alarmed: Joints that have left their thresholds, shape (n,).
        ends: First column of each effect of the bank, and P, shape (N + 1,).
        price: Penalty of a parameter [1].
    """
    total, share, count = 0.0, 1.0, 0
    for j in range(len(gram)):
        if not alarmed[j] or unit[j] == 0.0:
            continue
        gain, explained = -np.inf, 0.0
        for e in range(len(ends) - 1):
            first, end = ends[e], ends[e + 1]
            right = gram[j, first:end, -1]
            theta, energy = ridge_solve(gram[j, first:end, first:end], right), 0.0
            for k in range(end - first):
                energy += theta[k] * right[k]
            explained = max(explained, energy / max(gram[j, -1, -1], TINY))
            gain = max(gain, energy / unit[j] - price * (end - first))
        total, share, count = total + gain, min(share, explained), count + 1
    return total - COINCIDENCE * max(count - 1, 0), share


@njit(cache=True, error_model="numpy")
def of_arm(gram, unit, first, end, prior, theta, precision):
    """Fit an effect to all joints together; return what it gains, its share of all, and what it leaves.

    Args:
        gram: Gram matrices of [y z; r], upper triangles, shape (n, P + A + 1, P + A + 1).
        unit: Of a gain of log-likelihood [(N·m)² s], 0 for a joint that does not count, shape (n,).
        first: Its first column.
        end: The column after its last one.
        prior: Prior standard deviations of its parameters, ``inf`` where nothing is known, shape (p,).
        theta: Its parameters; filled, shape (p,).
        precision: Inverse of their covariance at the healthy noise; filled, shape (p, p).
    """
    p = end - first
    right, count = np.zeros(p), 0
    precision[:] = 0.0
    for j in range(len(gram)):
        if unit[j] == 0.0:
            continue
        count += 1
        for i in range(p):
            right[i] += gram[j, first + i, -1] * 2.0 / unit[j]
            for k in range(i, p):
                precision[i, k] += gram[j, first + i, first + k] * 2.0 / unit[j]
    for i in range(p):
        precision[i, i] += 1.0 / prior[i] ** 2
        for k in range(i):
            precision[i, k] = precision[k, i]
    theta[:] = ridge_solve(precision, right)
    gain, energy = 0.0, 0.0
    for j in range(len(gram)):
        if unit[j] == 0.0:
            continue
        less = 0.0
        for i in range(p):
            less += 2.0 * gram[j, first + i, -1] * theta[i] - gram[j, first + i, first + i] * theta[i] ** 2
            for k in range(i + 1, p):
                less -= 2.0 * gram[j, first + i, first + k] * theta[i] * theta[k]
        gain += less / unit[j]
        energy += gram[j, -1, -1] / unit[j]
    return gain, gain / max(energy, TINY), 2.0 * (energy - gain) / max(count, 1)


@njit(cache=True, error_model="numpy")
def decided(
    gram, weight, level, independent, alarmed, own_ends, ends, prior, unusual, price, only, theta, precision
):
    """Return the effect that gains most, and what there is to know of it; −1 if there is too little motion.

    Args:
        gram: Gram matrices of [y z; r], upper triangles, shape (n, P + A + 1, P + A + 1).
        weight: Durations of the samples in them [s], shape (n,).
        level: RMS of a healthy residual [N·m or N], shape (n,).
        independent: Time for which it stays alike [s], shape (n,).
        alarmed: Joints that have left their thresholds, shape (n,).
        own_ends: First column of each effect of the bank, and P, shape (N + 1,).
        ends: First column of each effect of the whole arm, and the last one's end, shape (K + 1,).
        prior: Prior standard deviations of their parameters, ``inf`` where nothing is known, shape (A,).
        unusual: Which of them arms hardly ever have, shape (K,).
        price: Penalty of a parameter [1].
        only: Index of the one effect that is fitted; −1 for all.
        theta: Parameters of all effects; filled, shape (A,).
        precision: Inverses of their covariances at the healthy noise; blocks are filled, shape (A, A).

    Returns:
        Index, lead over all other causes [1], share of the remainder that it explains [1], energy of what it leaves of
        a joint over that of one independent healthy sample [1], and least share that the joints' own effects explain.
    """
    best, first, second, explained, left = -1, -np.inf, -np.inf, 0.0, 0.0
    unit = units(gram, weight, level, independent)
    if not unit.any():
        return best, first, explained, left, 0.0
    joints, share = of_joints(gram, unit, alarmed, own_ends, price)
    for i in range(len(ends) - 1):
        if only >= 0 and i != only:
            continue
        a, b = ends[i] - ends[0], ends[i + 1] - ends[0]
        gain, its_share, its_rest = of_arm(
            gram, unit, ends[i], ends[i + 1], prior[a:b], theta[a:b], precision[a:b, a:b]
        )
        lead = gain - price * (b - a) - (UNUSUAL if unusual[i] else 0.0)
        if lead > first:
            best, first, second = i, lead, first
            explained, left = its_share, its_rest
        elif lead > second:
            second = lead
    return best, first - max(joints, second), explained, left, share
