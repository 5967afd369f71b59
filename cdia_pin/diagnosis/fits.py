"""Least-squares fits of all combinations of effects to the normal equations of a joint, and their scores, compiled."""

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
def ranked(
    gram,
    ends,
    lower,
    upper,
    required,
    prior,
    centre,
    most,
    weight,
    noise2,
    independent,
    tolerance2,
    price,
    out_theta,
    out_score,
    out_order,
):
    """Fit and score every combination of effects that contains the required ones; return how many are possible.

    Combinations are visited so that each is another one with one effect more, behind those that it has. Its Cholesky
    factor is then that of the other one with some rows more, and nothing is factorised twice.

    Args:
        gram: Gram matrix of [y; r], upper triangle, the bank's columns first, the residual last, shape
            (P + 1, P + 1) or larger.
        ends: Columns of the effects, shape (N + 1,).
        lower: Smallest parameters, shape (P,).
        upper: Largest parameters, shape (P,).
        required: Effects that every combination contains, one bit each.
        prior: Precision of the parameters that are believed already, beside the Gram matrix, shape (P,).
        centre: Parameters that are believed already, shape (P,).
        most: Largest number of effects besides the required ones.
        weight: Number of samples in the Gram matrix [1].
        noise2: Square of the RMS that the residual is allowed to keep [(N·m)² or N²].
        independent: Correlation time of a healthy residual [samples].
        tolerance2: Mean square that a possible combination may leave, over ``noise2`` [1].
        price: Penalty of each parameter, and of each effect after the first [1].
        out_theta: Parameters of the possible combinations; filled, shape (2^N, P).
        out_score: Scores; filled, infinite for a combination that is not possible, shape (2^N,).
        out_order: The possible combinations by score; its first entries are filled, shape (2^N,).
    """
    N = len(ends) - 1
    P = int(ends[N])
    last = len(gram) - 1
    full, right, scale = np.empty((P, P)), np.empty(P), np.empty(P)
    for i in range(P):
        for k in range(i, P):
            full[i, k] = full[k, i] = gram[i, k]
        d = full[i, i] + prior[i]
        scale[i] = 1.0 / np.sqrt(d) if d > 0.0 else 0.0
        right[i] = gram[i, last]
    energy = gram[last, last]
    L, half, theta = np.zeros((P, P)), np.empty(P), np.empty(P)
    index, width = np.empty(P, np.int64), np.zeros(N + 1, np.int64)
    failed = np.zeros(N + 1, np.bool_)  # whether the factor of the effects before each one does not exist
    out_score[:] = np.inf
    for code in range(1 << N):
        # The first effect has the highest bit of a code, so that each code appends one effect to an earlier one.
        e = N - 1
        while e >= 0 and not code >> (N - 1 - e) & 1:
            e -= 1
        mask = 0
        for i in range(e + 1):
            if code >> (N - 1 - i) & 1:
                mask |= 1 << i
        p = 0
        if e >= 0:
            missing = required & ~mask & ((1 << e) - 1)
            extra, count = mask & ~required, 0
            while extra:
                extra &= extra - 1
                count += 1
            p = width[e]
            dead = failed[e] or missing != 0 or count > most
            if not dead:
                for k in range(ends[e], ends[e + 1]):
                    index[p] = k
                    dead = not extend(full, right, index, p, prior, centre, scale, L, half)
                    if dead:
                        break
                    p += 1
            for i in range(e + 1, N + 1):  # until one of these effects is appended
                width[i], failed[i] = p, dead
            if dead:
                continue
        if mask & required != required:
            continue
        rss, ok = finish(full, right, energy, index, p, scale, L, half, theta)
        for i in range(p):
            k = index[i]
            slack = np.sqrt(max(rss, 0.0) / max(full[k, k], TINY)) * BOUND_SLACK
            if theta[i] < lower[k] - slack or theta[i] > upper[k] + slack:
                ok = False
        rss = max(rss, 0.0)
        if not ok or not rss / weight <= tolerance2 * noise2:
            continue
        effects, rest = 0, mask
        while rest:
            rest &= rest - 1
            effects += 1
        out_score[mask] = 0.5 * rss / noise2 / independent + price * (p + max(effects - 1, 0))
        out_theta[mask] = 0.0
        for i in range(p):
            out_theta[mask, index[i]] = theta[i]
    return sort(out_score, out_order)


@njit(cache=True)
def extend(full, right, index, p, prior, centre, scale, L, half):
    """Add a column to a Cholesky factor and to its forward substitution; return whether the factor exists.

    Args:
        full: Gram matrix of y, shape (P, P).
        right: Σ y r, shape (P,).
        index: The columns; the first p entries are in the factor, the next one is added.
        p: Number of columns in the factor.
        prior: Precision of the parameters that are believed already, shape (P,).
        centre: Parameters that are believed already, shape (P,).
        scale: Inverse roots of the diagonal with the prior, zero where there are none, shape (P,).
        L: The factor of the scaled matrix; a row is filled, shape (P, P).
        half: Forward substitution; an entry is filled, shape (P,).
    """
    own = index[p]
    if scale[own] == 0.0:
        return False
    for k in range(p + 1):
        value = full[own, index[k]] * scale[own] * scale[index[k]]
        if k == p:
            value += prior[own] * scale[own] * scale[own] + RIDGE
        for m in range(k):
            value -= L[p, m] * L[k, m]
        if k == p:
            if value < LEAST_PIVOT:
                return False
            L[p, p] = np.sqrt(value)
        else:
            L[p, k] = value / L[k, k]
    value = (right[own] + prior[own] * centre[own]) * scale[own]
    for m in range(p):
        value -= L[p, m] * half[m]
    half[p] = value / L[p, p]
    return True


@njit(cache=True)
def finish(full, right, energy, index, p, scale, L, half, theta):
    """Solve for the parameters of some columns; return the sum of squared residuals, and whether it is a number.

    Args:
        full: Gram matrix of y, shape (P, P).
        right: Σ y r, shape (P,).
        energy: Σ r² [(N·m)² or N²].
        index: The columns; the first p entries count.
        p: Number of columns.
        scale: Inverse roots of the diagonal with the prior, shape (P,).
        L: The factor of the scaled matrix, shape (P, P).
        half: Forward substitution, shape (P,).
        theta: Parameters; the first p entries are filled, shape (P,).
    """
    for i in range(p - 1, -1, -1):
        value = half[i]
        for m in range(i + 1, p):
            value -= L[m, i] * theta[m]
        theta[i] = value / L[i, i]
    for i in range(p):
        theta[i] *= scale[index[i]]
    rss = energy
    for i in range(p):
        rss -= 2.0 * theta[i] * right[index[i]]
        for k in range(p):
            rss += theta[i] * theta[k] * full[index[i], index[k]]
    return rss, np.isfinite(rss)


@njit(cache=True)
def sort(score, order):
    """Fill the indices of the finite scores, least first, equal ones by index; return their number.

    Args:
        score: Scores, shape (K,).
        order: Their indices; the first entries are filled, shape (K,).
    """
    count = 0
    for m in range(len(score)):
        if not np.isfinite(score[m]):
            continue
        at = count
        while at > 0 and score[order[at - 1]] > score[m]:
            order[at] = order[at - 1]
            at -= 1
        order[at] = m
        count += 1
    return count


@njit(cache=True)
def variances(gram, columns, out):
    """Fill the diagonal of the inverse of the normal equations of some columns; return whether there is one.

    Args:
        gram: Gram matrix of [y; r], upper triangle, shape (P + 1, P + 1) or larger.
        columns: The columns in rising order, shape (p,).
        out: Diagonal of the inverse; filled, shape (p,).
    """
    p = len(columns)
    L, row = np.zeros((p, p)), np.zeros(p)
    for i in range(p):
        if not gram[columns[i], columns[i]] > TINY:
            return False
    for i in range(p):
        own = gram[columns[i], columns[i]]
        for k in range(i + 1):
            value = gram[columns[k], columns[i]] / np.sqrt(own * gram[columns[k], columns[k]])
            for m in range(k):
                value -= L[i, m] * L[k, m]
            if i == k:
                if not value > LEAST_PIVOT:
                    return False
                L[i, i] = np.sqrt(value)
            else:
                L[i, k] = value / L[k, k]
    out[:] = 0.0
    for k in range(p):  # the k-th column of L⁻¹
        for i in range(k, p):
            value = 1.0 if i == k else 0.0
            for m in range(k, i):
                value -= L[i, m] * row[m]
            row[i] = value / L[i, i]
            out[k] += row[i] * row[i]
    for k in range(p):
        out[k] /= gram[columns[k], columns[k]]
    return True
