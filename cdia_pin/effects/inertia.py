"""Inertia that is not as the URDF says: a wrong link, a tool bolted on or missing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.body import Body
from cdia_pin.effects.plausibility import Plausibility
from cdia_pin.robot.inertia import transform_parameters
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinkInertia(Body):
    """The inertial parameters of the link moved by a joint differ from the URDF, f = −Y δπ [Wensing2018].

    The parameters are differences to the URDF, about the joint's frame. Several links that all differ slightly are one
    effect, written with their joints: link_inertia@JOINT+JOINT.

    Attributes:
        joint: Name of the joint that moves the link.
    """

    joint: str

    name: ClassVar[str] = "link_inertia"
    equation: ClassVar[str] = "−Y δπ"
    plausibility: ClassVar[Plausibility] = Plausibility(penalty=3.0)  # a tool changes more often than a link
    scope_fields: ClassVar[tuple[str, ...]] = ("joint",)

    def carrier(self, robot: RobotModel) -> int:
        """Return the index of the joint.

        Args:
            robot: The arm, n joints.
        """
        return robot.joint_index(self.joint)

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return bounds that leave the link at least a twentieth of its mass, and add no more than all links weigh.

        What asks for more than that has another cause, near whose torque the link's happens to be.

        Args:
            robot: The arm, n joints.
        """
        lower, upper = super().bounds(robot)
        lower[0] = -0.95 * robot.inertial_parameters[self.carrier(robot)][0]
        upper[0] = robot.total_mass
        return lower, upper

    @classmethod
    def scopes(cls, robot: RobotModel) -> Iterator[tuple[str, ...]]:
        """Yield every joint that moves a link.

        Args:
            robot: The arm, n joints.
        """
        yield from ((j,) for j in robot.joints)


@dataclass(frozen=True)
class Payload(Body):
    """A rigid body on the tool, f = −Y_tool π [Wensing2018].

    The parameters are about the tool frame. A negative mass means that the real arm lacks a tool which the
    URDF carries; link and payload together stay a possible body.
    """

    name: ClassVar[str] = "payload"
    equation: ClassVar[str] = "−Y_tool π"

    def carrier(self, robot: RobotModel) -> int:
        """Return the index of the joint that moves the tool.

        Args:
            robot: The arm, n joints.
        """
        return robot.joint_index(robot.tool_joint)

    def to_joint_frame(self, robot: RobotModel) -> Array:
        """Return A with π_joint = A π: from the tool frame to that of the tool's joint, shape (10, 10).

        Args:
            robot: The arm, n joints.
        """
        return _tool_transform(robot)

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return bounds that take away no more mass than the URDF carries on the tool's link.

        Args:
            robot: The arm, n joints.
        """
        lower, upper = super().bounds(robot)
        lower[0] = -0.98 * robot.inertial_parameters[self.carrier(robot)][0]
        return lower, upper


@lru_cache(maxsize=32)
def _tool_transform(robot: RobotModel) -> Array:
    return transform_parameters(robot.tool_placement)
