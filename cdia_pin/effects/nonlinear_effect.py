"""Effects whose torque is not linear in their parameters: a subclass gives the torque."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.state import State

Array = NDArray[np.float64]


class NonlinearEffect(Effect):
    """An effect whose torque is not linear in θ: a subclass gives `torque`, the rest is differentiated."""

    steps: ClassVar[
        tuple[float, ...]
    ] = ()  # finite-difference step of each parameter, in its unit; 1e-5 if empty

    @abstractmethod
    def torque(self, x: State, theta: Array) -> Array:
        """Return f [N·m or N] for parameters θ (p,), shape (N, n).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """

    def jacobian(self, x: State, theta: Array) -> Array:
        """Return ∂f/∂θ by central differences, shape (N, n, p).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        out = np.empty((len(x), x.robot.n, self.size))
        for i, step in enumerate(self.steps or (1e-5,) * self.size):
            shift = np.zeros(self.size)
            shift[i] = step
            out[:, :, i] = (self.torque(x, theta + shift) - self.torque(x, theta - shift)) / (2 * step)
        return out

    def basis(self, x: State) -> Array:
        """Return ∂f/∂θ at θ = 0, shape (N, n, p).

        Args:
            x: Motion and torques, N samples.
        """
        return self.jacobian(x, np.zeros(self.size))
