"""Where a fault is present: the region P_j of its profile, learned from where it was seen ([Thesis] 2.2.2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Region

Array = NDArray[np.float64]

PRESENT, ABSENT = 0.6, 0.3  # [1], share of the predicted torque above, or below which it is there, or is not
ENOUGH = 20  # sightings of either kind
MOST = 2000  # sightings that are kept
PURE = 0.93  # [1], share of sightings that a region must get right


class RegionLearner:
    """Collect sightings of an effect of a joint, and say in which region it is present.

    Args:
        joint: Name of the joint.
    """

    def __init__(self, joint: str) -> None:
        self.joint = joint
        self._seen: list[tuple[bool, float, float]] = []

    def add(self, share: float, q: float, v: float) -> None:
        """Add a sighting.

        Args:
            share: Torque that is there over the torque that the effect would have [1].
            q: Position [rad or m].
            v: Velocity [rad/s or m/s].
        """
        if share > PRESENT or share < ABSENT:
            self._seen.append((share > PRESENT, q, v))
            del self._seen[:-MOST]

    @property
    def region(self) -> Region | None:
        """The half-line of position, velocity or speed that tells best, if it tells well."""
        present = np.array([s[0] for s in self._seen], bool)
        if present.sum() < ENOUGH or (~present).sum() < ENOUGH:
            return None
        q, v = (np.array([s[i] for s in self._seen]) for i in (1, 2))
        best: tuple[float, Region] | None = None
        for signal, x in (("speed", np.abs(v)), ("position", q), ("velocity", v)):
            cut, above, right = best_cut(x, present)
            if right >= PURE and (best is None or right > best[0] + 0.01):
                limits = {"lower": cut} if above else {"upper": cut}
                best = right, Region(self.joint, signal, **limits)
        return best[1] if best else None


def best_cut(x: Array, present: NDArray[np.bool_]) -> tuple[float, bool, float]:
    """Return the cut that tells present from absent best, whether present is above it, and its balanced accuracy."""
    order = np.argsort(x)
    x, present = x[order], present[order]
    weight = np.where(present, 0.5 / present.sum(), -0.5 / (~present).sum())
    below = np.cumsum(weight)  # share of the present below less share of the absent below, halved
    i_above, i_below = int(np.argmin(below)), int(np.argmax(below))
    above, under = 0.5 - below[i_above], 0.5 + below[i_below]
    i = i_above if above >= under else i_below
    cut = 0.5 * (x[i] + x[min(i + 1, len(x) - 1)])
    return float(cut), bool(above >= under), float(max(above, under))
