"""Overlap of motions: on which joints logs before and after can be compared, and why they cannot on the others."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.regression.shares import LEAST
from cdia_pin.selection.discovery_settings import ChangeSettings

Mask = NDArray[np.bool_]


class NotCompared(StrEnum):
    """Why nothing is known about a joint."""

    RESTS_BEFORE = "rests before"
    RESTS_AFTER = "rests after"
    OTHER_SPEEDS = "moves at other speeds"
    NO_EFFORT = "no effort was recorded"


@dataclass(frozen=True, repr=False)
class Overlap:
    """Samples at which each joint moves alike before and after.

    Attributes:
        used: True for samples that count, shape (K, n).
        reasons: Why a joint is not compared, by its index.
    """

    used: Mask
    reasons: dict[int, NotCompared]

    def __repr__(self) -> str:
        return f"Overlap({self.used.shape[1] - len(self.reasons)} of {self.used.shape[1]} joints)"

    @classmethod
    def of(cls, experiment: Experiment, after: Mask, settings: ChangeSettings) -> Self:
        """Find the samples that count.

        Args:
            experiment: The conditioned logs.
            after: True for compared samples of the logs after, shape (K,).
            settings: How much a joint must move, how far beyond the other side, and the number of blocks of time.
        """
        sides = (~after, after)
        moving = [experiment.moving[side].mean(axis=0) for side in sides]
        within = experiment.moving & _within_reach(experiment, after, settings.reach)
        silent = np.any([rms(experiment.measured, side[:, None]) <= LEAST for side in sides], axis=0)
        fewest = np.min([within[side].sum(axis=0) for side in sides], axis=0)
        reasons: dict[int, NotCompared] = {}
        for j in range(within.shape[1]):
            if moving[0][j] < settings.least_moving:
                reasons[j] = NotCompared.RESTS_BEFORE
            elif moving[1][j] < settings.least_moving:
                reasons[j] = NotCompared.RESTS_AFTER
            elif silent[j]:  # it moves, so an inertia at least must show
                reasons[j] = NotCompared.NO_EFFORT
            elif fewest[j] < settings.blocks:  # some blocks of time would say nothing
                reasons[j] = NotCompared.OTHER_SPEEDS
        within[:, list(reasons)] = False
        return cls(within, reasons)


def _within_reach(experiment: Experiment, after: Mask, reach: float) -> Mask:
    """Return True where a joint is no faster than in the logs of the other side, shape (K, n).

    Friction at a speed that one side never reaches is an extrapolation there, and its error seems to be a change.

    Args:
        experiment: The conditioned logs.
        after: True for compared samples of the logs after, shape (K,).
        reach: Largest speed over the fastest of the other side [1].
    """
    speed = np.abs(experiment.compared_motion()[2])
    fastest = [speed[side].max(axis=0) for side in (after, ~after)]
    return np.asarray(speed <= reach * np.where(after[:, None], fastest[1], fastest[0]), bool)
