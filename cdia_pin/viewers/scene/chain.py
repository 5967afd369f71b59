"""The moving joints of an arm as a drawing needs them, from its forward kinematics alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SceneJoint:
    """A joint of the chain: pose in the base = pose of its parent · placement · motion(axis, q).

    Attributes:
        name: Its name.
        parent: The joint before it; None for the first.
        placement: Of its frame at q = 0 in the frame of its parent, homogeneous, shape (4, 4) [1, m].
        axis: Unit vector in its own frame, shape (3,).
        prismatic: Whether it slides along the axis, and does not turn about it.
    """

    name: str
    parent: str | None
    placement: Array
    axis: Array
    prismatic: bool


def chain_of(robot: RobotModel) -> tuple[SceneJoint, ...]:
    """Return the joints of an arm, from the base on.

    Args:
        robot: The arm; it is one chain.
    """
    rest = robot.joint_placements(np.zeros(robot.n))
    moved = robot.joint_placements(np.eye(robot.n))  # one joint at 1 rad or 1 m, the others at 0
    joints = []
    for j, name in enumerate(robot.joints):
        motion = np.linalg.inv(rest[j]) @ moved[j, j]
        prismatic = bool(robot.is_prismatic[j])
        axis = motion[:3, 3] if prismatic else _axis(motion[:3, :3])
        before = rest[j - 1] if j else np.eye(4)
        parent = robot.joints[j - 1] if j else None
        joints.append(SceneJoint(name, parent, np.linalg.inv(before) @ rest[j], axis, prismatic))
    return tuple(joints)


def _axis(rotation: Array) -> Array:
    """Return the axis of a rotation by 1 rad, shape (3,)."""
    skew = (rotation - rotation.T) / (2 * np.sin(1.0))
    return np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
