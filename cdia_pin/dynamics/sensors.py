"""Sensors of a simulated arm: noise and rounding of their readings."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import ModelError

Array = NDArray[np.float64]

MOST_NOISE = 10.0  # [1], of a torque over its RMS: nothing is left of it


@dataclass(frozen=True)
class Sensors:
    """Imperfections of the sensors of a simulated arm; none by default.

    Noise is white and normal. It is part of the recording only: the controller reads without it.

    Attributes:
        position_noise: Standard deviation of the positions' noise [rad or m].
        position_quantum: Step of the encoders [rad or m].
        velocity_noise: Standard deviation of the velocities' noise [rad/s or m/s].
        effort_noise: Standard deviation of the torques' noise [N·m or N].
        effort_share: A share of each joint's RMS torque [1] that is added to ``effort_noise``.
        velocity: True if velocities are recorded.
    """

    position_noise: float = 0.0
    position_quantum: float = 0.0
    velocity_noise: float = 0.0
    effort_noise: float = 0.0
    effort_share: float = 0.0
    velocity: bool = True

    def __post_init__(self) -> None:
        for f in fields(self):
            if not 0.0 <= getattr(self, f.name) < np.inf:
                raise ModelError(f"sensors: {f.name} must be 0 or more, given {getattr(self, f.name)}")
        if self.effort_share > MOST_NOISE:
            raise ModelError(f"sensors: effort_share must be up to {MOST_NOISE:g}, given {self.effort_share}")

    @property
    def noisy(self) -> bool:
        """True if any reading has noise, so that a random generator is needed."""
        return any((self.position_noise, self.velocity_noise, self.effort_noise, self.effort_share))

    def read_position(self, q: Array, rng: np.random.Generator | None) -> Array:
        """Return positions as they are recorded.

        Args:
            q: True positions [rad or m], shape (N, n).
            rng: Source of the noise; None for no noise.

        Returns:
            Positions with noise, rounded to the step of the encoders [rad or m], shape of q.
        """
        return quantised(_with_noise(q, self.position_noise, rng), self.position_quantum)

    def read_velocity(self, v: Array, rng: np.random.Generator | None) -> Array | None:
        """Return velocities as they are recorded.

        Args:
            v: True velocities [rad/s or m/s], shape (N, n).
            rng: Source of the noise; None for no noise.

        Returns:
            Velocities with noise [rad/s or m/s], shape of v; None if they are not recorded.
        """
        return _with_noise(v, self.velocity_noise, rng) if self.velocity else None

    def read_effort(self, tau: Array, rng: np.random.Generator | None) -> Array:
        """Return torques as they are recorded.

        Args:
            tau: True torques [N·m or N], shape (N, n).
            rng: Source of the noise; None for no noise.

        Returns:
            Torques with noise [N·m or N], shape of tau.
        """
        return _with_noise(tau, self.effort_noise + self.effort_share * np.sqrt(np.mean(tau**2, axis=0)), rng)


def quantised(signal: Array, quantum: float) -> Array:
    """Round a signal to multiples of a quantum.

    Args:
        signal: Values in any unit, any shape.
        quantum: Step [unit of the signal]; 0 for no rounding.

    Returns:
        Rounded values, shape of signal.
    """
    return signal if quantum == 0.0 else quantum * np.round(signal / quantum)


def _with_noise(signal: Array, deviation: float | Array, rng: np.random.Generator | None) -> Array:
    if rng is None or not np.any(deviation):
        return signal.copy()
    return signal + deviation * rng.standard_normal(signal.shape)
