"""The plain momentum observer with a constant threshold: what a monitor must beat.

    r = K (p − ∫ (τ + Cᵀq̇ − g + r) dt),     p = M q̇,

which tends to the missing torque f with the time constant 1/K. Explicit Euler, velocities as measured, one
threshold for each joint.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from benchmarks.online.rigid_body import RigidBody
from benchmarks.online.run import OnlineRun
from cdia_pin.robot import RobotModel

Array = NDArray[np.float64]

GAIN = 20.0  # [1/s], K
MARGIN = 1.3  # over the largest residual of healthy runs [1]


def residual(robot: RobotModel, run: OnlineRun, gain: float = GAIN) -> Array:
    """Return r along a run [N·m or N], shape (K, n).

    Args:
        robot: The arm that the observer believes in.
        run: Measured positions, velocities and commands.
        gain: K [1/s].

    Raises:
        ValueError: If the run has no measured velocities.
    """
    if run.v_measured is None:
        raise ValueError("the momentum observer needs measured velocities; the run has positions only")
    body, tick = RigidBody(robot), run.tick
    out = np.zeros_like(run.q)
    integral, r = np.zeros(robot.n), np.zeros(robot.n)
    for k in range(len(run.time)):
        momentum, passive = body.momentum_terms(run.q_measured[k], run.v_measured[k])
        if k == 0:
            integral = momentum  # so that r begins at zero
        r = gain * (momentum - integral)
        out[k] = r
        integral = integral + tick * (run.command[k] + passive + r)
    return out


def threshold(residuals: ArrayLike, margin: float = MARGIN) -> Array:
    """Return `margin` times the largest |r| of healthy runs, shape (n,)."""
    rows = np.abs(np.asarray(residuals, float))
    return margin * rows.reshape(-1, rows.shape[-1]).max(axis=0)


def detection_times(time: Array, residuals: Array, thresholds: ArrayLike) -> Array:
    """Return when each |r| is first beyond its threshold [s], NaN where it never is, shape (n,).

    Args:
        time: Time of the ticks [s], shape (K,).
        residuals: r [N·m or N], shape (K, n).
        thresholds: Same unit, shape (n,) or (K, n).
    """
    beyond = np.abs(residuals) > thresholds
    first = time[np.argmax(beyond, axis=0)]
    return np.where(beyond.any(axis=0), first, np.nan)
