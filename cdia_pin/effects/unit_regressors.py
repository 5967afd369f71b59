"""Samples with unit regressors: what a rigid body or a tilt makes of them is a matrix, the same for all motions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.state import State
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class UnitRegressors(State):
    """10 n + 3 samples; in each, one column of [Y K] is 1 on all joints, and the others are 0."""

    @classmethod
    def of_robot(cls, robot: RobotModel) -> Self:
        """Return the samples of an arm.

        Args:
            robot: The arm, n joints.
        """
        zero = np.zeros((10 * robot.n + 3, robot.n))
        return cls(robot, zero, zero, zero, zero, zero[:, 0])

    def body_regressor(self, joint: int) -> Array:
        """Y of a body on a joint's link, shape (N, n, 10)."""
        return self._on_all_joints(10 * joint, 10)

    @property
    def gravity_regressor(self) -> Array:
        """K with G = K g, shape (N, n, 3)."""
        return self._on_all_joints(10 * self.robot.n, 3)

    def _on_all_joints(self, first: int, count: int) -> Array:
        unit = np.eye(len(self))[:, first : first + count]
        return np.repeat(unit[:, None], self.robot.n, axis=1)


def on_regressors(effect: Effect, robot: RobotModel) -> Array:
    """Return A with ∂f/∂θ = [Y K] A near θ = 0, shape (10 n + 3, p).

    Y is the regressor of all bodies, K that of gravity. So the columns of one sample cost a product, and the effect's
    formula stands in the effect alone.

    Args:
        effect: A body or a tilt: its torque depends on the motion by Y and K alone.
        robot: The arm, n joints.
    """
    return effect.jacobian(UnitRegressors.of_robot(robot), np.zeros(effect.size))[:, 0]
