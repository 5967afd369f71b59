"""The region P_j of the motion in which a fault is present, learned from where it was seen ([Thesis] §2.2.2)."""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.effects import Region

Array = NDArray[np.float64]

PRESENT_SHARE = (
    0.6  # [1], share of the predicted torque above which a sighting says that the fault is present
)
ABSENT_SHARE = 0.3  # [1], share below which it says that it is absent; in between it says neither
LEAST_SIGHTINGS = 20  # of either kind, before a region is stated
KEPT_SIGHTINGS = 2000  # at 20 looks a second, the last 100 s
LEAST_ACCURACY = 0.93  # [1], balanced share of sightings that a region must get right
CLEARLY_BETTER = (
    0.01  # [1], accuracy that a later signal must gain: speed is preferred to position and velocity
)


class RegionLearner(Stateful):
    """Sightings of an effect of a joint, and the region that they show.

    Args:
        joint: Name of the joint.
    """

    STATE = ("_seen", "_present")

    def __init__(self, joint: str) -> None:
        self.joint = joint
        self._seen: deque[tuple[bool, float, float]] = deque()
        self._present = 0  # sightings in which the fault was present

    def add(self, share: float, q: float, v: float) -> None:
        """Add a sighting.

        Args:
            share: Torque that is there over the torque that the effect predicts [1].
            q: Position [rad or m].
            v: Velocity [rad/s or m/s].
        """
        if share > PRESENT_SHARE or share < ABSENT_SHARE:
            self._seen.append((share > PRESENT_SHARE, q, v))
            self._present += share > PRESENT_SHARE
            if len(self._seen) > KEPT_SIGHTINGS:
                self._present -= self._seen.popleft()[0]

    @property
    def region(self) -> Region | None:
        """The half-line of speed, position or velocity that separates the sightings best; None if none does well."""
        if min(self._present, len(self._seen) - self._present) < LEAST_SIGHTINGS:
            return None
        present = np.array([s[0] for s in self._seen], bool)
        q, v = (np.array([s[i] for s in self._seen]) for i in (1, 2))
        best: tuple[float, Region] | None = None
        for signal, x in (("speed", np.abs(v)), ("position", q), ("velocity", v)):
            cut, above, right = best_cut(x, present)
            if right >= LEAST_ACCURACY and (best is None or right > best[0] + CLEARLY_BETTER):
                limits = {"lower": cut} if above else {"upper": cut}
                best = right, Region(self.joint, signal, **limits)
        return best[1] if best else None


def best_cut(x: Array, present: NDArray[np.bool_]) -> tuple[float, bool, float]:
    """Return the cut that separates present from absent best, whether present is above it, and its accuracy.

    Args:
        x: The signal at each sighting, shape (K,).
        present: Whether the fault was present, shape (K,).

    Returns:
        Cut in the signal's unit, side, and balanced accuracy [1].
    """
    order = np.argsort(x)
    x, present = x[order], present[order]
    weight = np.where(present, 0.5 / present.sum(), -0.5 / (~present).sum())
    below = np.cumsum(weight)  # share of the present below less share of the absent below, halved
    i_above, i_below = int(np.argmin(below)), int(np.argmax(below))
    above, under = 0.5 - below[i_above], 0.5 + below[i_below]
    i = i_above if above >= under else i_below
    cut = 0.5 * (x[i] + x[min(i + 1, len(x) - 1)])
    return float(cut), bool(above >= under), float(max(above, under))
