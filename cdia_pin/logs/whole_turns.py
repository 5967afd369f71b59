"""Angles that wrap: an encoder reads one turn more or less from one sample to the next."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.angle_size import limited
from cdia_pin.phrases import counted

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

TURN = 2.0 * np.pi  # [rad]
# [turn], largest motion of a joint between two samples, beside the turn. At 20 Hz it is a speed of 13 rad/s. A step of
# nine to eleven tenths of a turn is one of a wrap; half and twice decide alike on 132 measured logs, in four of which a
# joint wraps.
MOTION = 0.1
# [s], longest time between the samples of a wrap. Nine tenths of a turn in it would be 28 rad/s, which no arm reaches;
# in a longer gap a joint may make a turn. Half and twice decide alike on the same logs.
LONGEST = 0.2
BACK = 4  # [samples] within which a turn that is taken back is one event, whatever gap one of its steps is in


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
    lower, upper, bounded = robot.limits.lower, robot.limits.upper, limited(robot)
    out, wrapping, often = position, [], 0
    # a joint that wraps has read nearly a turn: others cost neither time nor memory
    read = np.flatnonzero(~robot.is_prismatic & (np.ptp(position, axis=0) > (1.0 - MOTION) * TURN))
    for k in read.tolist():
        after, turns = _wraps(time, position[:, k])
        if not len(after):
            continue
        out = position.copy() if out is position else out
        made = np.zeros(len(position))
        made[after] = turns
        out[:, k] -= TURN * np.cumsum(made)
        middle = (lower[k] + upper[k]) / 2.0 if bounded[k] else 0.0
        about = (out[:, k].min() + out[:, k].max()) / 2.0
        out[:, k] -= TURN * np.round((about - middle) / TURN)  # the same joint is alike in all logs
        wrapping.append(robot.joints[k])
        often += len(after)
    if not wrapping:
        return position, []
    said = f"{counted(often, 'jump')} of positions by one turn, as encoders make that wrap, left out"
    return out, [f"{said}: {', '.join(wrapping)}"]


def _wraps(time: Array, angle: Array) -> tuple[NDArray[np.intp], Array]:
    """Return the rows before which an angle wraps and its turns there [1], shape (w,) each; none if others step too."""
    step = np.diff(angle)
    step /= TURN
    far = np.flatnonzero(np.abs(step) > MOTION)
    turn, gap = np.round(step[far]), np.diff(time)[far]
    whole = (np.abs(turn) == 1.0) & (np.abs(step[far] - turn) <= MOTION)
    taken_back = (np.diff(far) <= BACK) & (turn[1:] == -turn[:-1]) & whole[1:] & whole[:-1]
    soon = gap <= LONGEST
    either = taken_back & (soon[1:] | soon[:-1])  # else each such row of a bus that fails is a turn more
    whole &= soon | np.append(either, False) | np.append(False, either)
    between = np.abs(step[far]) < 1.0 - MOTION
    at, turn = far[whole], turn[whole]
    onward = (np.diff(at) == 1) & (turn[1:] == turn[:-1])
    if onward.any() or len(at) <= between.sum():
        at, turn = at[:0], turn[:0]
    return at + 1, turn
