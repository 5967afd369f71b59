"""Angles that are beyond what a joint reaches in rad, and so are degrees by their size."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.magnitudes import largest_of

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

MARGIN = 1.2  # [1], over the limit of a joint, or over one turn, by which zeros of encoders differ
TOO_FAST = 5.0  # [1], speed over the URDF's limit that no arm reaches; degrees read as rad make 57
USUAL = 90.0  # [%], of the samples have less than the speed that counts, so that single wild samples do not


def limited(robot: RobotModel) -> NDArray[np.bool_]:
    """Return which joints have limits of position, shape (n,)."""
    return np.asarray(np.isfinite(robot.limits.lower) & np.isfinite(robot.limits.upper))


def beyond_reach(position: Array, time: Array | None, robot: RobotModel) -> NDArray[np.bool_]:
    """Return which joints go further than they can in rad, shape (n,).

    A joint without limits may make many turns; only its speed tells, where the URDF has a limit of it.

    Args:
        position: Positions as logged, shape (N, n).
        time: Time [s], shape (N,); None if it is not known.
        robot: The robot of the log.
    """
    limits, bounded = robot.limits, limited(robot)
    turns = np.maximum(2 * np.pi, np.where(bounded, limits.upper, 0.0))
    beyond = ~robot.is_prismatic & (largest_of(position) > MARGIN * turns)
    for k in np.flatnonzero(beyond & ~bounded).tolist():
        speed = np.zeros(1) if time is None else np.abs(np.diff(position[:, k]) / np.diff(time))
        beyond[k] = np.percentile(speed, USUAL) > TOO_FAST * limits.velocity[k]
    return np.asarray(beyond)
