"""Rigid bodies on links: who carries them, and their parameters beside those of the link."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


class RigidBody(ABC):
    """A rigid body on the link of a joint, π = (mass, first moments, second moments) in a frame of its own."""

    @abstractmethod
    def carrier(self, robot: RobotModel) -> int:
        """Return the index of the joint whose link the body is part of.

        Args:
            robot: The arm, n joints.
        """

    def to_joint_frame(self, robot: RobotModel) -> Array:
        """Return A with π_joint = A π, from the body's frame to that of the joint, shape (10, 10).

        Args:
            robot: The arm, n joints.
        """
        return np.eye(10)

    def in_joint_frame(self, theta: Array, robot: RobotModel) -> Array:
        """Return the parameters of a body θ = π about the frame of the carrying joint, shape (10,).

        Args:
            theta: π in the body's frame [kg, kg·m, kg·m²], shape (10,).
            robot: The arm, n joints.
        """
        return self.to_joint_frame(robot) @ theta

    def total(self, theta: Array, robot: RobotModel) -> Array:
        """Return the parameters of link and body θ = π together, about the joint's frame, shape (10,).

        Args:
            theta: π in the body's frame [kg, kg·m, kg·m²], shape (10,).
            robot: The arm, n joints.
        """
        link: Array = robot.inertial_parameters[self.carrier(robot)]
        return link + self.in_joint_frame(theta, robot)
