"""Faults that have gone ([Thesis] §3.7)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class ClearanceMonitor:
    """Declares an effect absent once its own torque |c φ| has stayed small on every joint for long enough.

    The thesis sums an effect's coefficients, in which signs cancel and units mix.

    Args:
        torque: ρ, what counts as absent [N·m or N], shape (n,).
        time: t_pr [s].
    """

    def __init__(self, torque: Array, time: float) -> None:
        self._torque, self._time = torque, time
        self._quiet: dict[int, float] = {}

    def step(self, torques: dict[int, Array], duration: float) -> tuple[int, ...]:
        """Return which effects are absent.

        Args:
            torques: Torque of each effect that is accommodated, (n,), by a key of its own.
            duration: Time since the last call [s].
        """
        self._quiet = {
            key: self._quiet.get(key, 0.0) + duration
            for key, torque in torques.items()
            if (np.abs(torque) < self._torque).all()
        }
        return tuple(key for key, quiet in self._quiet.items() if quiet >= self._time)
