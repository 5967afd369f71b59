"""Effects of one joint: a subclass gives the columns of that joint, the rest is the same for all."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.state import JointState, State
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class JointEffect(Effect):
    """An effect of one joint on its own torque: a subclass gives its columns.

    Attributes:
        joint: Name of the joint.
    """

    joint: str

    scope_fields: ClassVar[tuple[str, ...]] = ("joint",)

    @abstractmethod
    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the torque per unit of each parameter, p arrays of shape (N,).

        Args:
            x: Signals of the joint, N samples.
        """

    def of_joint(self, x: State) -> JointState:
        """Return what `columns` can see: the signals of the joint.

        Args:
            x: Motion and torques, N samples.
        """
        return x.joint(self.joint)

    def basis(self, x: State) -> Array:
        """Return Φ, zero but for the row of the joint, shape (N, n, p).

        Args:
            x: Motion and torques, N samples.
        """
        out = np.zeros((len(x), x.robot.n, self.size))
        row = out[:, x.robot.joint_index(self.joint), :]
        for i, column in enumerate(self.columns(self.of_joint(x))):
            row[:, i] = column
        return out

    def torque(self, x: State, theta: Array) -> Array:
        """Return f [N·m or N] for parameters θ (p,), shape (N, n); a simulation asks for it at every step.

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        out = np.zeros((len(x), x.robot.n))
        own = out[:, x.robot.joint_index(self.joint)]
        for column, value in zip(self.columns(self.of_joint(x)), theta, strict=True):
            own += column * value
        return out

    def acts_on(self, robot: RobotModel) -> tuple[int, ...]:
        """Return the index of the joint.

        Args:
            robot: The arm, n joints.
        """
        return (robot.joint_index(self.joint),)

    @classmethod
    def scopes(cls, robot: RobotModel) -> Iterator[tuple[str, ...]]:
        """Yield every joint.

        Args:
            robot: The arm, n joints.
        """
        yield from ((j,) for j in robot.joints)
