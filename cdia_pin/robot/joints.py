"""Facts about the joints of an arm: their limits, and the joints that are locked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class JointLimits:
    """Limits of every joint as the URDF states them; ``inf`` where it states none.

    Attributes:
        lower: Smallest position [rad or m], shape (n,).
        upper: Largest position [rad or m], shape (n,).
        velocity: Largest speed [rad/s or m/s], shape (n,).
        effort: Largest torque or force [N·m or N], shape (n,).
    """

    lower: Array
    upper: Array
    velocity: Array
    effort: Array

    def __repr__(self) -> str:
        bounded = int(np.sum(np.isfinite(self.lower) & np.isfinite(self.upper)))
        return f"JointLimits({len(self.lower)} joints, {bounded} with a bounded range)"


@dataclass(frozen=True)
class LockedJoint:
    """A joint of the URDF that does not move here.

    Attributes:
        position: Position at which it is locked [rad or m].
        reason: Why it is not part of the arm.
    """

    position: float
    reason: str
