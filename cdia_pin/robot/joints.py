"""Facts about the joints of an arm: their limits, and the joints that are locked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HALF = np.pi  # [rad or m] to each side: a whole turn shows all postures, and most slides are shorter
LITTLE = 1.0  # [rad]; a turning joint that has less of its range within half a turn of zero moves elsewhere


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

    def usual_range(self, slides: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Return a range of every joint from which postures can be drawn [rad or m], shape (n,) each.

        It is the joint's own range, with half a turn or π m for an end that is not stated. A joint that turns stays
        within half a turn of zero, or of the middle of its range if it moves elsewhere.

        Args:
            slides: True for joints that slide, shape (n,).
        """
        near_lower, near_upper = np.maximum(self.lower, -HALF), np.minimum(self.upper, HALF)
        lower = np.where(np.isfinite(self.lower), self.lower, np.minimum(-HALF, self.upper - HALF))
        upper = np.where(np.isfinite(self.upper), self.upper, np.maximum(HALF, self.lower + HALF))
        middle = (lower + upper) / 2
        most = np.where(slides, np.inf, HALF)
        elsewhere = slides | (near_upper - near_lower < LITTLE)
        return (
            np.where(elsewhere, np.maximum(lower, middle - most), near_lower),
            np.where(elsewhere, np.minimum(upper, middle + most), near_upper),
        )

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
