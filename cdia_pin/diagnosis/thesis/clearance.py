"""Clearance: faults that are no longer present, the idle monitoring of [Thesis] §3.7."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.stateful import Stateful

Array = NDArray[np.float64]


class ClearanceMonitor(Stateful):
    """Calls an effect absent when its own torque |c φ| has stayed small on every joint for long enough.

    The thesis sums the coefficients of an effect; there signs cancel and units mix.

    Args:
        torque: ρ, torque below which an effect counts as absent [N·m or N], shape (n,).
        time: t_pr, how long the torque must stay below it [s].
    """

    STATE = ("_quiet",)

    def __init__(self, torque: Array, time: float) -> None:
        self._torque, self._time = torque, time
        self._quiet: dict[int, float] = {}

    def step(self, torques: dict[int, Array], duration: float) -> tuple[int, ...]:
        """Return the keys of the effects that are absent.

        Args:
            torques: Torque of each accommodated effect [N·m or N], shape (n,), by its key.
            duration: Time since the last call [s].
        """
        self._quiet = {
            key: self._quiet.get(key, 0.0) + duration
            for key, torque in torques.items()
            if (np.abs(torque) < self._torque).all()
        }
        return tuple(key for key, quiet in self._quiet.items() if quiet >= self._time)
