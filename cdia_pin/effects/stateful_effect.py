"""Effects of one joint with memory: a subclass says how its state steps, and what torque it gives."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.joint_effect import JointEffect
from cdia_pin.effects.memory import Memory
from cdia_pin.effects.state import JointState, State

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StatefulEffect(Memory, JointEffect):
    """An effect of one joint whose torque depends on the past, as friction at a reversal does.

    A subclass gives `initial_state`, `step`, and `columns` that read the state from `JointState.memory`.

    Attributes:
        joint: Name of the joint.
    """

    @property
    def memories(self) -> tuple[Memory, ...]:
        """The effect itself."""
        return (self,)

    @abstractmethod
    def step(self, z: Array, x: JointState, dq: float, dt: float) -> Array:
        """Return z after a step of the joint, shape (m,).

        Args:
            z: At the beginning of the step, shape (m,).
            x: The joint at the beginning of the step; each signal has shape (1,).
            dq: Motion of the joint during the step [rad or m].
            dt: Duration of the step [s], above 0.
        """

    def advance(self, z: Array, x: State, dq: Array, dt: float) -> Array:
        """Return z after a step of the arm, shape (m,); see `Memory.advance`.

        Args:
            z: At the beginning of the step, shape (m,).
            x: One sample at the beginning of the step.
            dq: Motion during the step [rad or m], shape (n,).
            dt: Duration of the step [s], above 0.
        """
        return self.step(z, x.joint(self.joint), float(dq[x.robot.joint_index(self.joint)]), dt)

    def of_joint(self, x: State) -> JointState:
        """Return the signals of the joint, with z at each sample.

        Args:
            x: Motion and torques, N samples.
        """
        return replace(x.joint(self.joint), memory=self.along(x))
