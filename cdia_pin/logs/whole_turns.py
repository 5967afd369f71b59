"""Angles that wrap: an encoder reads one turn more or less from one sample to the next."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.phrases import counted
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

TURN = 2.0 * np.pi  # [rad]
# Largest motion of a joint between two samples, beside the turn [1 of a turn]. At 20 Hz it is a speed of 13 rad/s. A
# step of nine to eleven tenths of a turn is one of a wrap; half and twice decide alike on 132 measured logs, in four of
# which a joint wraps.
MOTION = 0.1
# Longest time between the samples of a wrap [s]. In a longer gap a joint may make a turn.
LONGEST = 0.2


def without_wraps(time: Array, position: Array, robot: RobotModel) -> tuple[Array, list[str]]:
    """Make angles continuous that jump by one turn between two samples, about the middle of what the joint can reach.

    Degrees that are read as radians have such steps too, where a joint moves fast. In such a log steps of less than a
    turn are more frequent, or one step of a turn follows another.

    Args:
        time: Time of each sample [s], shape (N,).
        position: Positions [rad or m], shape (N, n).
        robot: The robot of the log, n joints.

    Returns:
        Positions [rad or m], shape (N, n), and a note if some have changed.
    """
    step = np.diff(position, axis=0) / TURN
    jump = np.where(np.isfinite(step), np.round(step), 0.0)
    wraps = (np.abs(jump) == 1.0) & (np.abs(step - jump) <= MOTION) & (np.diff(time) <= LONGEST)[:, None]
    between = (np.abs(step) > MOTION) & (np.abs(step) < 1.0 - MOTION)
    onward = wraps[1:] & wraps[:-1] & (jump[1:] == jump[:-1])
    wraps &= ~robot.is_prismatic & (wraps.sum(axis=0) > between.sum(axis=0)) & ~onward.any(axis=0)
    if not wraps.any():
        return position, []
    out = position.copy()
    out[1:] -= TURN * np.cumsum(np.where(wraps, jump, 0.0), axis=0)
    lower, upper = robot.limits.lower, robot.limits.upper
    middle = np.where(np.isfinite(lower) & np.isfinite(upper), (lower + upper) / 2.0, 0.0)
    for k in np.flatnonzero(wraps.any(axis=0)):  # the same joint is alike in all logs
        about = (np.nanmin(out[:, k]) + np.nanmax(out[:, k])) / 2.0
        out[:, k] -= TURN * np.round((about - middle[k]) / TURN)
    where = ", ".join(j for j, w in zip(robot.joints, wraps.any(axis=0), strict=True) if w)
    often = counted(int(wraps.sum()), "jump")
    return out, [f"{often} of positions by one turn, as encoders make that wrap, left out: {where}"]
