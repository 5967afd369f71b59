r"""The share of an effort that physics explains, in any unit.

.. math:: \tau_j \approx \alpha (M \ddot q + V)_j + \gamma G_j
          + \beta_v \dot q_j + \beta_c\,\mathrm{sgn}\,\dot q_j + I_j \ddot q_j + c,
          \qquad \alpha, \gamma, \beta_v, \beta_c, I_j \ge 0

Coefficients that are not negative in nature are bounded at zero: friction dissipates, inertia resists, gravity
pulls as in the URDF. So a wrong sign, order or unit of angle fits badly, whatever the unit of torque or drive gain.
"""

from __future__ import annotations

import itertools
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.motion import SmoothedMotion, sign_of

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

FLOOR = 0.01  # [1], share of the variance that no URDF explains; smaller differences mean nothing


def physical_columns(motion: SmoothedMotion, robot: RobotModel) -> Array:
    """Compute the columns (M q̈ + V)ⱼ, Gⱼ, q̇ⱼ, sgn q̇ⱼ, q̈ⱼ of every joint.

    Args:
        motion: Signals in SI units.
        robot: The robot of the log.

    Returns:
        Columns [N·m or N, twice; rad/s or m/s; 1; rad/s² or m/s²], shape (n, N, 5).
    """
    gravity = robot.gravity(motion.q)
    dynamic = robot.inverse_dynamics(motion.q, motion.v, motion.a) - gravity
    stacked = np.stack([dynamic, gravity, motion.v, sign_of(motion.v), motion.a], axis=-1)  # (N, n, 5)
    return np.asarray(stacked.transpose(1, 0, 2))


def unexplained(effort: Array, columns: Array, parts: int = 1) -> float:
    """Compute the share of the variance of one effort that physics leaves unexplained.

    Args:
        effort: Effort of a joint in any unit, shape (N,).
        columns: Columns of that joint, shape (N, k).
        parts: Number of parts of the time that have coefficients of their own; the variance is then that within
            these parts.

    Returns:
        Share, 0 to 1 [1]; NaN for a constant effort.
    """
    split = zip(np.array_split(effort, parts), np.array_split(columns, parts), strict=True)
    squares = [_squares(y, x) for y, x in split]
    left, total = np.sum(squares, axis=0).tolist()
    if total <= 1e-18 * max(float(effort @ effort), 1e-30):
        return float("nan")
    return max(float(left / total), 0.0)


def _squares(effort: Array, columns: Array) -> tuple[float, float]:
    """Return the sums of squares that the columns and a constant leave, and that a constant alone leaves."""
    y = effort - effort.mean()
    total = float(y @ y)
    x = columns - columns.mean(axis=0)
    size = np.sqrt((x * x).sum(axis=0))
    x = x[:, size > 1e-12] / size[size > 1e-12]
    return _nonnegative_residual(x.T @ x, x.T @ y, total), total


def misfit(share: Array) -> float:
    """Sum the logarithm of the unexplained shares over the joints.

    Args:
        share: Unexplained share of each joint [1], shape (n,); NaN is left out.

    Returns:
        Misfit [1]; one unit is a factor of e.
    """
    return float(np.nansum(np.log(share + FLOOR)))


def _nonnegative_residual(gram: Array, moment: Array, total: float) -> float:
    """Minimise |y − X c|² with c ≥ 0: try every set of columns that may be active (at most 5 columns)."""
    k = len(moment)
    gram = gram + 1e-9 * np.eye(k)
    best = total
    for size in range(k, 0, -1):
        active = _subsets(k, size)  # (sets, size)
        c = np.linalg.solve(gram[active[:, :, None], active[:, None, :]], moment[active][..., None])[..., 0]
        allowed = c.min(axis=1) >= 0
        if allowed.any():
            best = min(best, float(total - (c * moment[active]).sum(axis=1)[allowed].max()))
        if allowed.all():
            break  # fewer columns cannot explain more
    return best


@cache
def _subsets(k: int, size: int) -> NDArray[np.intp]:
    return np.array(list(itertools.combinations(range(k), size)), dtype=np.intp)
