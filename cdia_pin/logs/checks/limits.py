"""What the URDF's limits and the log say of each other, and efforts that were clipped."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.logs.checks.finding import Finding
from cdia_pin.logs.checks.motion import Motion
from cdia_pin.logs.log import Log

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

TOLERANCE = 0.01  # [rad or m]; encoder noise at a hard stop


def check_limits(log: Log, robot: RobotModel) -> Iterator[Finding]:
    """Positions, speeds and efforts beyond what the URDF allows."""
    limits = robot.limits
    found = False
    speeds = np.zeros(robot.n) if log.velocity is None else np.abs(log.velocity).max(axis=0)
    for k, joint in enumerate(log.joints):
        low, high = float(log.position[:, k].min()), float(log.position[:, k].max())
        if low < limits.lower[k] - TOLERANCE or high > limits.upper[k] + TOLERANCE:
            found = True
            yield Finding(
                "limits",
                "warning",
                f"positions from {low:.4g} to {high:.4g} leave the URDF's range {limits.lower[k]:.4g} to "
                f"{limits.upper[k]:.4g}",
                joint=joint,
                advice="check unit, sign and zero of the position (convert angle=deg, flip_position=…), the order "
                "of the joints (joint_map), and that this is the robot",
                value={"lowest": low, "highest": high},
            )
        for what, most, limit in (
            ("speed", float(speeds[k]), float(limits.velocity[k])),
            ("effort", float(np.abs(log.effort[:, k]).max()), float(limits.effort[k])),
        ):
            if most > 1.1 * limit:
                found = True
                yield Finding(
                    "limits",
                    "warning",
                    f"{what} up to {most:.4g}, the URDF's limit is {limit:.4g}",
                    joint=joint,
                    advice=f"check the unit of the {what} and that this is the robot",
                    value={what: most, "limit": limit},
                )
    if not found:
        yield Finding("limits", "ok", "positions, speeds and efforts lie within the URDF's limits")


def check_saturation(log: Log, robot: RobotModel, motion: Motion | None) -> Iterator[Finding]:
    """Efforts at the URDF's limit, or cut off at a level of their own."""
    found = False
    speed = np.abs(np.gradient(log.position, log.time, axis=0))
    for k, joint in enumerate(log.joints):
        effort = log.effort[:, k]
        at_limit = float(np.mean(np.abs(effort) > 0.99 * robot.limits.effort[k]))
        clipped, level = 0.0, 0.0
        if motion is not None and motion.moves[k]:
            moving = speed[:, k] > 0.02 * speed[:, k].max()
            clipped, level = max(_plateau(effort[moving]), _plateau(-effort[moving]))
        if at_limit > 1e-3 or clipped > 5e-3:
            found = True
            where = (
                f"at the URDF's limit of {robot.limits.effort[k]:.4g} in {at_limit:.1%} of the samples"
                if at_limit > 1e-3
                else f"cut off at {level:.4g} in {clipped:.1%} of the samples in motion"
            )
            yield Finding(
                "saturation",
                "warning",
                f"the effort is {where}: what the joint did there is not what the log says",
                joint=joint,
                advice="leave those parts out (Log.slice), or repeat the motion more slowly",
                value={"share": max(at_limit, clipped), "level": level or float(robot.limits.effort[k])},
            )
    if not found:
        yield Finding("saturation", "ok", "no effort is cut off or at its limit")


def _plateau(effort: np.ndarray) -> tuple[float, float]:
    """Share of samples exactly at the maximum, if they are more than lie just below it; and the level."""
    if len(effort) < 100:
        return 0.0, 0.0
    top = float(effort.max())
    band = 0.03 * (top - float(effort.min()))
    at_top = int(np.sum(effort >= top - 1e-6 * max(abs(top), band)))
    below = int(np.sum(effort > top - band)) - at_top
    clipped = at_top >= 5 and at_top > below and band > 0
    return (at_top / len(effort), abs(top)) if clipped else (0.0, 0.0)
