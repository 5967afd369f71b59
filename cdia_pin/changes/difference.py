"""The difference of an effect between logs before and logs after."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect, Traits, WrappedEffect
from cdia_pin.effects.rigid_body import RigidBody
from cdia_pin.effects.state import State
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Difference(WrappedEffect):
    """An effect by which some logs differ from the others. Its parameters may have either sign.

    Attributes:
        effect: The effect.
        logs: Names of the logs in which it is present, see `State.log`.
        sign: 1 if these are the logs after, −1 if they are those before: parameters are those after less those before.
    """

    effect: Effect
    logs: tuple[str, ...]
    sign: float = 1.0

    @property
    def traits(self) -> Traits:
        """Traits of the effect, but not dissipative, because a difference of friction may add power."""
        return replace(self.effect.traits, dissipative=False)

    @property
    def bodies(self) -> tuple[RigidBody, ...]:
        """No bodies, because a difference between two bodies need not be physically consistent."""
        return ()

    def basis(self, x: State) -> Array:
        """Return the effect's basis, zero in the other logs.

        Args:
            x: State along one log, N samples.

        Returns:
            Torque per unit of each parameter [N·m or N per unit], shape (N, n, p).
        """
        return (
            self.sign * self.effect.basis(x)
            if self._is_present(x)
            else np.zeros((len(x), x.robot.n, self.size))
        )

    def torque(self, x: State, theta: Array) -> Array:
        """Return the effect's torque, zero in the other logs.

        Args:
            x: State along one log, N samples.
            theta: Differences of the parameters, shape (p,).

        Returns:
            In N·m or N, shape (N, n).
        """
        return (
            self.effect.torque(x, self.sign * theta) if self._is_present(x) else np.zeros((len(x), x.robot.n))
        )

    def torques(self, x: State, efforts: Array, theta: Array) -> Array:
        """Return the effect's torque under several actuator torques, zero in the other logs.

        Args:
            x: State along one log, N samples; its ``effort`` is not used.
            efforts: The actuator torques [N·m or N], shape (N, n, k).
            theta: Differences of the parameters, shape (p,).

        Returns:
            In N·m or N, shape (N, n, k).
        """
        present = self._is_present(x)
        return self.effect.torques(x, efforts, self.sign * theta) if present else np.zeros_like(efforts)

    def jacobian(self, x: State, theta: Array) -> Array:
        """Return the effect's ∂f/∂θ, zero in the other logs.

        Args:
            x: State along one log, N samples.
            theta: Differences of the parameters, shape (p,).

        Returns:
            Torque per unit of each parameter [N·m or N per unit], shape (N, n, p).
        """
        return (
            self.sign * self.effect.jacobian(x, self.sign * theta)
            if self._is_present(x)
            else np.zeros((len(x), x.robot.n, self.size))
        )

    def shift(self, x: State, theta: Array) -> Array:
        """Return the effect's shift of positions, zero in the other logs.

        Args:
            x: State along one log, N samples.
            theta: Differences of the parameters, shape (p,).

        Returns:
            In rad or m, shape (N, n).
        """
        return (
            self.effect.shift(x, self.sign * theta) if self._is_present(x) else np.zeros((len(x), x.robot.n))
        )

    def gravity_change(self, x: State, theta: Array) -> Array:
        """Return the effect's change of gravity, zero in the other logs.

        Args:
            x: State along one log, N samples.
            theta: Differences of the parameters, shape (p,).

        Returns:
            In m/s², shape (N, 3).
        """
        return (
            self.effect.gravity_change(x, self.sign * theta) if self._is_present(x) else np.zeros((len(x), 3))
        )

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return the differences between two sizes that are both within the effect's bounds.

        What only the logs before have was within them there.

        Args:
            robot: The robot.

        Returns:
            Smallest and largest differences, shape (p,) each; infinite where the effect has only one bound, or none.
        """
        lower, upper = self.effect.bounds(robot)
        return (lower - upper, upper - lower) if self.sign > 0 else (-upper, -lower)

    def is_physical(self, theta: Array, robot: RobotModel) -> bool:
        """Return True: any difference is possible on a real arm."""
        return True

    def nearest_physical(self, theta: Array, robot: RobotModel) -> Array:
        """Return the estimate unchanged, shape (p,)."""
        return np.array(theta, float)

    def is_distinct(self, theta: Array) -> bool:
        """Return True: any difference counts."""
        return True

    def _is_present(self, x: State) -> bool:
        """Tell whether the effect is present in the log of a state."""
        return x.log in self.logs
