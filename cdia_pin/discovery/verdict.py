"""The verdict of a discovery, and the rule that decides it."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from cdia_pin.selection.discovery_settings import PracticeSettings

Array = NDArray[np.float64]


class DiscoveryVerdict(StrEnum):
    """What a discovery concludes."""

    NOTHING_MISSING = "nothing-missing"
    EXPLAINED = "explained"
    EXPLAINED_IN_PRACTICE = "explained-in-practice"
    UNEXPLAINED = "unexplained"


def stands_out(residual: Array, floor: Array, practice: PracticeSettings) -> NDArray[np.bool_]:
    """Return on which joints a residual is structure by its size alone, shape (n,).

    In a short log, or where little of the torque is the model's, no test may prove structure. A residual that is
    several times what no smooth function of the motion explains is no noise all the same.

    Args:
        residual: RMS residual, over the torque [1], shape (n,).
        floor: RMS that no smooth function of the motion explains, over the torque [1], shape (n,).
        practice: When structure does not matter.
    """
    return (residual > practice.tolerable_error) & (residual > practice.tolerable_structure * floor)


def verdict_on(
    structure_left: Sequence[bool], error: Array, floor: Array, added: int, practice: PracticeSettings
) -> DiscoveryVerdict:
    """Return the verdict: structure that is left outweighs all that was found, but only where it matters.

    Args:
        structure_left: Whether the residual of each joint is more than noise, shape (n,).
        error: Error on data that was not fitted, over the torque [1], shape (n,).
        floor: Error that no smooth function of the motion explains, over the torque [1], shape (n,).
        added: Number of effects that were added.
        practice: When structure does not matter.
    """
    left = np.asarray(structure_left, bool)
    several = (error > practice.tolerable_structure * floor) & (error > practice.negligible_error)
    matters = (error > practice.tolerable_error) | several
    if (left & matters).any():
        return DiscoveryVerdict.UNEXPLAINED
    if left.any():
        return DiscoveryVerdict.EXPLAINED_IN_PRACTICE
    return DiscoveryVerdict.EXPLAINED if added else DiscoveryVerdict.NOTHING_MISSING
