"""One log of an experiment."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import State
from cdia_pin.logs.motion import Motion
from cdia_pin.logs.repeats import lag_between, period_of
from cdia_pin.logs.side_evidence import SideEvidence, side_evidence
from cdia_pin.logs.torque_side import TorqueSide
from cdia_pin.phrases import clipped

Array = NDArray[np.float64]

# Relative difference of the time between compared samples, up to which places agree: a block is a thirtieth of a log.
SAME_PACE = 0.01  # [1]
JUDGED = 800  # samples of a log [1] by which the side of its torque is judged


@dataclass(frozen=True, repr=False)
class Segment:
    """One log of an experiment.

    Attributes:
        motion: The conditioned motion.
        state: State along the motion.
        measured: Measured torque at the compared samples [N·m or N], shape (K, n).
    """

    motion: Motion
    state: State
    measured: Array

    def __repr__(self) -> str:
        return f"Segment({clipped(self.state.log)}, {len(self.measured)} compared samples)"

    @cached_property
    def distinct(self) -> int:
        """Number of compared samples before the motion repeats [1]; all of them if it does not, one at least."""
        period = None if self.motion.stretches else period_of(self.motion.q[self.motion.kept])
        return max(len(self.measured) if period is None else period, 1)

    def lag_behind(self, other: Segment) -> int | None:
        """Return how many compared samples after another log this one begins, if both drive one motion, else None.

        Args:
            other: The other log. Of logs with gaps, or of unlike rates, it is not known.
        """
        if self.motion.stretches or other.motion.stretches:
            return None
        pace, others = (m.decimation / m.rate for m in (self.motion, other.motion))
        if abs(pace / others - 1.0) > SAME_PACE:
            return None
        return lag_between(other.motion.q[other.motion.kept], self.motion.q[self.motion.kept])

    @property
    def measured_side(self) -> TorqueSide:
        """Side of the gear on which the torque was measured, as far as the log itself shows it."""
        return self._side_evidence.side

    @property
    def belies_its_format(self) -> bool:
        """True if a format says that the torque was measured behind the gear, and it shows too much friction."""
        return self.motion.side_of_format and self._side_evidence.is_too_large_for_a_link

    @property
    def _side_evidence(self) -> SideEvidence:
        m = self.motion
        thin = np.s_[:: max(1, len(m.time) // JUDGED)]
        return side_evidence(self.state.robot, m.q[thin], m.v[thin], m.a[thin], m.effort[thin])
