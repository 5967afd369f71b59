"""Signals of a log beyond the URDF's limits, and efforts that were clipped."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.joint_units import units_of
from cdia_pin.logs.checks.motion import SmoothedMotion
from cdia_pin.logs.derivatives import speed_of
from cdia_pin.logs.log import Log
from cdia_pin.logs.magnitudes import largest_of
from cdia_pin.logs.resolution import quantum

if TYPE_CHECKING:
    from cdia_pin.robot.joints import JointLimits
    from cdia_pin.robot.model import RobotModel

TOLERANCE = 0.01  # [rad or m], beyond a limit of position: encoder noise at a hard stop
# Quantisation and noise of a clipped effort stay within it. On three measured arms the efforts that go through a limit
# exceed it by 2.3 to 9.6 %.
AT_LIMIT = 0.02  # distance of an effort from its limit, over the limit [1]
# One that covers a twentieth of its range exceeds it in mm; simulated ones ignored their limits by eight times.
FARTHEST = 50.0  # [1], travel over the range of its limits that no slide makes
SLACK = 1.1  # [1], speed or effort over its limit: noise and overshoot stay below it


def check_limits(log: Log, robot: RobotModel) -> Iterator[Finding]:
    """Report positions, speeds and efforts beyond the URDF's limits.

    Args:
        log: The log.
        robot: Its robot.

    Yields:
        A finding per kind of signal that is beyond, or one that none is.
    """
    limits = robot.limits
    units = [units_of(robot, k) for k in range(robot.n)]
    low, high = log.position.min(axis=0), log.position.max(axis=0)
    speed = np.zeros(robot.n) if log.velocity is None else largest_of(log.velocity)
    effort = largest_of(log.effort)
    outside = (low < limits.lower - TOLERANCE) | (high > limits.upper + TOLERANCE)
    impossible = robot.is_prismatic & (high - low > FARTHEST * _range(limits))
    unit = "length=mm" if robot.is_prismatic[outside].all() else "angle=deg"
    torque = "Nmm" if log.effort_tolerance is None else "mA"
    beyond = {
        "positions": (
            {
                k: f"{low[k]:.4g} to {high[k]:.4g} of {limits.lower[k]:.4g} to {limits.upper[k]:.4g} {units[k][0]}"
                for k in range(robot.n)
            },
            outside,
            f"check unit and sign of the position (--convert {unit}, flip_position=…), the order of the "
            "joints (--joint-map), and that this is the robot; a joint that turns without end is of type "
            "'continuous' in a URDF",
        ),
        "speeds": (
            {k: f"{speed[k]:.4g} of {limits.velocity[k]:.4g} {units[k][0]}/s" for k in range(robot.n)},
            speed > SLACK * limits.velocity,
            "check the unit of the velocity, and that this is the robot",
        ),
        "efforts": (
            {k: f"{effort[k]:.4g} of {limits.effort[k]:.4g} {units[k][1]}" for k in range(robot.n)},
            effort > SLACK * limits.effort,
            f"check the unit of the effort (--convert torque={torque}), and that this is the robot",
        ),
    }
    for what, (said, where, advice) in beyond.items():
        joints = np.flatnonzero(where).tolist()
        if joints:
            yield Finding(
                Topic.LIMITS,
                Severity.ERROR if what == "positions" and impossible.any() else Severity.WARNING,
                f"{what} beyond the URDF's limits: "
                + ", ".join(f"{log.joints[k]} {said[k]}" for k in joints),
                joint=log.joints[joints[0]] if len(joints) == 1 else None,
                advice=advice,
                value={"signal": what, "joints": [log.joints[k] for k in joints]},
            )
    if not any(where.any() for _, where, _ in beyond.values()):
        yield Finding(Topic.LIMITS, Severity.OK, "positions, speeds and efforts lie within the URDF's limits")


def _range(limits: JointLimits) -> NDArray[np.float64]:
    """Return how far each joint goes between its limits [rad or m], infinite where they leave no room, shape (n,)."""
    room = limits.upper - limits.lower
    return np.where(room > 0, room, np.inf)


def check_saturation(log: Log, robot: RobotModel, motion: SmoothedMotion | None) -> Iterator[Finding]:
    """Report efforts at the URDF's limit, or clipped at another level.

    Args:
        log: The log.
        robot: Its robot.
        motion: Smoothed signals; None for a log that is too short.

    Yields:
        A finding per joint with clipped efforts, or one that none is.
    """
    found = False
    for k, joint in enumerate(log.joints):
        effort = log.effort[:, k]
        ratio = np.abs(effort)
        ratio /= robot.limits.effort[k]
        at_limit = float(np.mean(ratio > 1 - AT_LIMIT)) if ratio.max() < 1 + AT_LIMIT else 0.0
        del ratio  # as large as the signal
        clipped, level = 0.0, 0.0
        if motion is not None and motion.moves[k]:
            speed = speed_of(log.position[:, k], log.time)
            moving = speed > 0.02 * speed.max()
            del speed
            clipped, level = _plateau(effort[moving])
        if at_limit > 1e-3 or clipped > 5e-3:
            found = True
            _, unit = units_of(robot, k)
            where = (
                f"at the URDF's limit of {robot.limits.effort[k]:.4g} {unit} in {at_limit:.1%} of the samples"
                if at_limit > 1e-3
                else f"clipped at {level:.4g} {unit} in {clipped:.1%} of the samples in motion"
            )
            yield Finding(
                Topic.SATURATION,
                Severity.WARNING,
                f"the effort is {where}: the true torque differs from the log there",
                joint=joint,
                advice="leave those parts out of the file, or repeat the motion more slowly",
                value={"share": max(at_limit, clipped), "level": level or float(robot.limits.effort[k])},
            )
    if not found:
        yield Finding(Topic.SATURATION, Severity.OK, "no effort is clipped or at its limit")


def _plateau(effort: np.ndarray) -> tuple[float, float]:
    """Return the share of samples at an extreme, if more lie there than just within it, and the level.

    The effort is negated in place, so give a copy of it.
    """
    if len(effort) < 100 or len(np.unique(effort)) < 20:  # every peak is flat if the rounding is so coarse
        return 0.0, 0.0
    rounding = 3.5 * quantum(effort)  # levels of rounding are no plateau
    above = _plateau_above(effort, rounding)
    return max(above, _plateau_above(np.negative(effort, out=effort), rounding))


def _plateau_above(effort: np.ndarray, rounding: float) -> tuple[float, float]:
    top = float(effort.max())
    band = max(0.03 * (top - float(effort.min())), rounding)
    at_top = int(np.sum(effort >= top - 1e-6 * max(abs(top), band)))
    below = int(np.sum(effort > top - band)) - at_top
    clipped = at_top >= 5 and at_top > below and band > 0
    return (at_top / len(effort), abs(top)) if clipped else (0.0, 0.0)
