"""What the controller sees of the arm: rounded positions, noisy velocities or none."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Sensors:
    """Imperfections of what the controller sees.

    Attributes:
        position_quantum: Quantum of a turning joint's position, after gearing [rad]; 0 for none.
        slide_quantum: Quantum of a sliding joint's position [m].
        velocity_std: Standard deviation of a turning joint's velocity, white [rad/s]; None if velocities are
            not measured at all.
        slide_velocity_std: The same for a sliding joint [m/s].
    """

    position_quantum: float = 2e-5  # 18 bit per revolution
    slide_quantum: float = 2e-6
    velocity_std: float | None = 1e-3
    slide_velocity_std: float = 1e-4

    def velocity_stds(self, slides: NDArray[np.bool_]) -> Array | None:
        """Return the standard deviation of each joint's velocity [rad/s or m/s], (n,); None if not measured."""
        if self.velocity_std is None:
            return None
        return np.where(slides, self.slide_velocity_std, self.velocity_std)


EXACT = Sensors(position_quantum=0.0, slide_quantum=0.0, velocity_std=0.0, slide_velocity_std=0.0)
POSITION_ONLY = Sensors(velocity_std=None)


class Readings:
    """What the sensors say, tick by tick, kept in arrays (K, n).

    Args:
        sensors: Their imperfections.
        slides: Which joints slide, shape (n,).
        ticks: Length of the run.
        rng: Source of the noise.
    """

    def __init__(
        self, sensors: Sensors, slides: NDArray[np.bool_], ticks: int, rng: np.random.Generator
    ) -> None:
        shape = ticks, len(slides)
        self.q = np.empty(shape)
        std = sensors.velocity_stds(slides)
        self.v = None if std is None else std * rng.standard_normal(shape)
        self._quantum = np.where(slides, sensors.slide_quantum, sensors.position_quantum)
        self._exact = not (self._quantum > 0).all()

    def __call__(self, k: int, q: Array, v: Array) -> tuple[Array, Array | None]:
        """Return position and velocity as read at tick k, for the true ones."""
        read = self.q[k]
        if self._exact:
            read[:] = q
        else:
            np.rint(q / self._quantum, out=read)
            read *= self._quantum
        if self.v is None:
            return read, None
        self.v[k] += v
        return read, self.v[k]
