"""Limits of a designed motion: those of the URDF with a margin, and assumptions where the URDF has none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import RobotError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# Share of a joint's range that a motion may use [1], so that a controller's overshoot stays inside.
RANGE = 0.95
WIDEST, LONGEST = 2.0, 0.3  # [rad], [m] from the middle of the range, because cables do not allow more
FASTEST, FASTEST_SLIDE = 3.0, 0.5  # [rad/s], [m/s]; no joint moves faster, so that the motion can be watched
UNSTATED, UNSTATED_SLIDE = 1.0, 0.25  # [rad/s], [m/s]; a slow motion, where the URDF states no limit
RISE = 0.5  # [s] in which a joint may reach its largest speed, where no acceleration is given
NO_ROOM = 1e-3  # [rad or m]; a joint with less than this half range cannot move


@dataclass(frozen=True, repr=False)
class MotionLimits:
    """Limits of a motion, shape (n,) each; infinite where there is no limit.

    Attributes:
        lower: Smallest position [rad or m].
        upper: Largest position [rad or m].
        velocity: Largest speed [rad/s or m/s].
        acceleration: Largest acceleration [rad/s² or m/s²].
        effort: Largest torque or force [N·m or N].
        assumed: Assumptions where the URDF states no limit, one sentence each.
    """

    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    effort: Array
    assumed: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"MotionLimits({len(self.lower)} joints, speed up to {self.velocity.max():.3g})"

    @property
    def middle(self) -> Array:
        """Middle of the range [rad or m], shape (n,)."""
        return (self.lower + self.upper) / 2

    @property
    def half(self) -> Array:
        """Half of the range [rad or m], shape (n,)."""
        return (self.upper - self.lower) / 2


def motion_limits(
    robot: RobotModel,
    *,
    speed: float = 0.8,
    effort: float = 0.8,
    acceleration: float | Mapping[str, float] | None = None,
) -> MotionLimits:
    """Return the limits of a motion: shares of the robot's limits.

    Args:
        robot: The arm.
        speed: Share of the velocity limits [1].
        effort: Share of the effort limits [1].
        acceleration: Largest acceleration, of all joints or by joint [rad/s² or m/s²]; without it, a joint reaches its
            speed limit in half a second.

    Raises:
        RobotError: If a setting is out of its range, a joint is unknown, or a joint has no room to move.
    """
    if not (0 < speed <= 1 and 0 < effort <= 1):
        raise RobotError(
            f"shares of the speed and effort limits must be above 0 and at most 1, given {speed:g} and {effort:g}"
        )
    stated = robot.limits
    slides = robot.is_prismatic
    half_most = np.where(slides, LONGEST, WIDEST)
    both = np.isfinite(stated.lower) & np.isfinite(stated.upper)
    with np.errstate(invalid="ignore"):  # inf − inf, where the other branch is taken
        middle = np.where(both, (stated.lower + stated.upper) / 2, 0.0)
        half = np.where(both, RANGE * (stated.upper - stated.lower) / 2, half_most)
    middle = np.where(both, middle, np.clip(middle, stated.lower + half_most, stated.upper - half_most))
    half = np.minimum(half, half_most)
    narrow = [j for j, room in zip(robot.joints, half, strict=True) if room < NO_ROOM]
    if narrow:
        raise RobotError(f"the limits of {', '.join(narrow)} leave no room to move: lock it, or widen them")
    unstated = np.where(slides, UNSTATED_SLIDE, UNSTATED)
    known = np.isfinite(stated.velocity)
    velocity = np.where(
        known, np.minimum(stated.velocity, np.where(slides, FASTEST_SLIDE, FASTEST)), unstated
    )
    velocity = velocity * np.where(known, speed, 1.0)
    return MotionLimits(
        lower=middle - half,
        upper=middle + half,
        velocity=velocity,
        acceleration=_accelerations(robot, velocity, acceleration),
        effort=effort * stated.effort,
        assumed=tuple(_assumed(robot, known, velocity)),
    )


def _accelerations(robot: RobotModel, velocity: Array, given: float | Mapping[str, float] | None) -> Array:
    most = velocity / RISE
    if isinstance(given, Mapping):
        for joint, value in given.items():
            most[robot.joint_index(joint)] = value
    elif given is not None:
        most = np.full(robot.n, float(given))
    if not (np.isfinite(most) & (most > 0)).all():
        raise RobotError(f"the largest acceleration must be above 0, given {given}")
    return most


def _assumed(robot: RobotModel, known: NDArray[np.bool_], velocity: Array) -> list[str]:
    out = []
    silent = [j for j, has in zip(robot.joints, known, strict=True) if not has]
    if silent:
        speeds = ", ".join(f"{x:g}" for x in sorted({*velocity[~known].tolist()}))
        out.append(
            f"the URDF states no velocity limit for {', '.join(silent)}: {speeds} rad/s or m/s assumed"
        )
    weak = [j for j, most in zip(robot.joints, robot.limits.effort, strict=True) if not np.isfinite(most)]
    if weak:
        out.append(f"the URDF states no effort limit for {', '.join(weak)}: their effort is not limited")
    return out
