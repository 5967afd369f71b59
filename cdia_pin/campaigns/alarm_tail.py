"""The rate of false alarms over the threshold: counted where there are alarms, extrapolated beyond."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log

import numpy as np
from numpy.typing import NDArray

from cdia_pin.campaigns.alarm_scores import BLOCK
from cdia_pin.campaigns.estimates import LEVEL, SEED
from cdia_pin.campaigns.run_row import RunRow
from cdia_pin.errors import CdiaError
from cdia_pin.phrases import counted

Array = NDArray[np.float64]

HOUR = 3600.0  # [s]
TAIL = 0.05  # [1], share of the highest seconds that the tail is fitted to
RESAMPLES = 200  # of the bootstrap: its highest twentieth is then ten values
FEWEST = 20  # seconds in the tail: an exponential's mean is then known to a fifth


@dataclass(frozen=True, eq=False)
class AlarmTail:
    """Peaks of healthy seconds, whose excess over a high level is exponential [Coles2001].

    Attributes:
        peaks: Largest residual over threshold of each second, arm by arm [1].
    """

    peaks: tuple[Array, ...]

    def __repr__(self) -> str:
        return f"AlarmTail({len(self.peaks)} arms, {self.hours:.3g} h)"

    @classmethod
    def of(cls, rows: Sequence[RunRow]) -> AlarmTail:
        """Return the tail of runs.

        Args:
            rows: Runs with the same settings.

        Raises:
            CdiaError: If there are too few healthy seconds.
        """
        arms: dict[tuple[str, float, float, float, int], list[float]] = {}
        for r in rows:
            arms.setdefault((r.robot, r.model_error, r.noise, r.speed, r.arm_seed), []).extend(r.peaks)
        found = cls(tuple(np.array(p) for p in arms.values() if p))
        require_enough(sum(map(len, found.peaks)))
        return found

    @property
    def hours(self) -> float:
        """Time without a fault [h]."""
        return BLOCK * sum(map(len, self.peaks)) / HOUR

    def is_extrapolated(self, rate: float) -> bool:
        """Tell whether fewer than one alarm is expected in all of the time at a rate.

        Args:
            rate: False alarms [1/h].
        """
        return rate * self.hours < 1

    def factor(self, rate: float) -> float:
        """Return the threshold that keeps a rate of false alarms with 95 % confidence, over that of the monitor [1].

        Whole arms are drawn anew, because seconds of one arm share its model error.

        Args:
            rate: Largest rate of false alarms [1/h].
        """
        rng = np.random.default_rng(SEED)
        drawn = rng.integers(len(self.peaks), size=(RESAMPLES, len(self.peaks)))
        levels = [_level(np.concatenate([self.peaks[k] for k in some]), rate) for some in drawn]
        return float(np.quantile(levels, LEVEL))


def require_enough(seconds: int) -> None:
    """Check that there are enough healthy seconds for a tail.

    Args:
        seconds: Number of seconds without a fault in the runs with the same settings.

    Raises:
        CdiaError: If there are too few.
    """
    if TAIL * seconds < FEWEST:
        raise CdiaError(
            f"{counted(seconds, 'healthy second')} are too few for a threshold, {FEWEST / TAIL:.0f} are needed: raise "
            "healthy or repeats"
        )


def _level(peaks: Array, rate: float) -> float:
    """Return the level that is exceeded at a rate [1/h]."""
    share = min(rate * BLOCK / HOUR, 1.0)  # of the seconds that exceed it
    if share >= TAIL:
        return float(np.quantile(peaks, 1 - share))
    base = float(np.quantile(peaks, 1 - TAIL))
    mean = float(np.mean(peaks[peaks > base] - base)) if (peaks > base).any() else 0.0
    return base + mean * log(TAIL / share)
