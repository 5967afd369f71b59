"""Torques of a motion: what the actuators give, and what a log reads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Torques:
    """Torques of a motion [N·m or N], each of shape (N, n).

    Attributes:
        actuator: Torque that the actuators must give.
        reading: Torque that a log would record.
        gain: 1 + ∂f/∂τ [1]; a missing torque f changes the actuator torque by −f / gain.
    """

    actuator: Array
    reading: Array
    gain: Array

    def __repr__(self) -> str:
        samples, joints = self.actuator.shape
        return f"Torques({samples} samples, {joints} joints)"
