"""What the conventions of a log have other than assumed, in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cdia_pin.logs.checks.conventions import Conventions
from cdia_pin.logs.checks.finding import Severity, Topic
from cdia_pin.logs.checks.mounting import turn_of, upright

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

FITTED_TURN = (
    60.0  # [°], most that `--mounted tilted` is offered for: the bound of the effect, 64°, leaves no room
)


class Difference(NamedTuple):
    """What the conventions of a log have other than assumed.

    Attributes:
        topic: Property of the log.
        message: What is different.
        advice: What to do.
        joints: Names of the joints concerned.
        severity: How much it matters.
    """

    topic: Topic
    message: str
    advice: str
    joints: list[str]
    severity: Severity = Severity.ERROR


def differences(robot: RobotModel, old: Conventions, new: Conventions) -> list[Difference]:
    """Return the differences between two conventions.

    Args:
        robot: The robot of the log.
        old: Conventions that were assumed.
        new: Conventions that fit.
    """
    said: list[Difference] = []
    if new.angle != old.angle:
        revolute = [j for j, slides in zip(robot.joints, robot.is_prismatic, strict=True) if not slides]
        said.append(
            Difference(Topic.UNITS, "positions are in degrees, not rad", "--convert angle=deg", revolute)
        )
    if new.gravity is not None and new.gravity != old.gravity:
        said.append(_mounted(robot, np.array(new.gravity)))
    moved = _moved(robot.joints, old.position_column, new.position_column)
    if moved:
        renames = ",".join(f"{column}={joint}" for joint, column in moved.items())
        said.append(
            Difference(
                Topic.JOINT_ORDER,
                f"the columns hold other joints ({_said(moved)})",
                f"--joint-map {renames}",
                [*moved],
            )
        )
    moved = _moved(robot.joints, old.effort_column, new.effort_column)
    if moved and new.effort_column != new.position_column:
        said.append(
            Difference(
                Topic.JOINT_ORDER,
                f"the efforts, but not the positions, are those of other joints ({_said(moved)})",
                "rename the effort columns",
                [*moved],
            )
        )
    position = _turned(robot.joints, old.position_sign, new.position_sign)
    effort = _turned(robot.joints, old.effort_sign, new.effort_sign)
    both = [j for j in position if j in effort]
    signs = (
        (both, "position, velocity and effort have the opposite sign", ("flip_position", "flip_effort")),
        (
            [j for j in position if j not in both],
            "position and velocity have the opposite sign",
            ("flip_position",),
        ),
        (
            [j for j in effort if j not in both],
            "the effort has the opposite sign and would feed energy into the joint",
            ("flip_effort",),
        ),
    )
    for joints, message, keys in signs:
        if joints:
            flags = " ".join(f"--convert {key}={','.join(joints)}" for key in keys)
            said.append(Difference(Topic.SIGN, f"{message} on {', '.join(joints)}", flags, joints))
    return said


def _mounted(robot: RobotModel, gravity: np.ndarray) -> Difference:
    """Describe how the base stands: by gravity in the base, and by its turn from the URDF's."""
    turn = turn_of(gravity, robot.gravity_vector)
    vector = ", ".join(f"{g:.2g}" for g in np.where(np.abs(gravity) < 0.05, 0.0, gravity))
    message = f"the base stands {turn:.0f}° from the URDF's (gravity in the base is about ({vector}) m/s²)"
    roll, pitch = upright(gravity)
    urdf = f'hang the base in the URDF on a fixed joint with rpy="{roll:.3g} {pitch:.3g} 0"'
    if turn > FITTED_TURN:
        return Difference(Topic.MOUNTING, message, urdf, list(robot.joints))
    advice = f"'cdia discover --mounted tilted' fits it; or {urdf}"
    return Difference(Topic.MOUNTING, message, advice, list(robot.joints), Severity.WARNING)


def _moved(joints: Sequence[str], old: Sequence[int], new: Sequence[int]) -> dict[str, str]:
    """Return, for each joint whose column changes, the joint whose column holds its numbers."""
    return {joints[k]: joints[new[k]] for k in range(len(joints)) if new[k] != old[k]}


def _turned(joints: Sequence[str], old: Sequence[int], new: Sequence[int]) -> list[str]:
    return [j for j, a, b in zip(joints, old, new, strict=True) if a != b]


def _said(moved: dict[str, str]) -> str:
    return ", ".join(f"{column} holds {joint}" for joint, column in moved.items())
