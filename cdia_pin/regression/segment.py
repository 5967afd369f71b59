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

    @cached_property
    def compared_state(self) -> State:
        """State at the compared samples."""
        return self.state.samples(self.motion.kept)

    @cached_property
    def since(self) -> Array:
        """Time of each compared sample since the first one [s], shape (K,)."""
        time = self.motion.time[self.motion.kept]
        return np.asarray(time - time[0])

    @property
    def duration(self) -> float:
        """Time that the motion lasts, without the pauses between its stretches [s]."""
        ends = np.cumsum(self.motion.stretches, dtype=int)[:-1]
        return float(sum(np.ptp(part) for part in np.split(self.motion.time, ends)))

    @property
    def pace(self) -> float:
        """Time between compared samples [s]."""
        return self.motion.decimation / self.motion.rate

    def lag_behind(self, other: Segment) -> float | None:
        """Return how long after another log this one begins, if both drive one motion, else None [s].

        Args:
            other: The other log. Of logs with gaps it is not known.
        """
        if self.motion.stretches or other.motion.stretches:
            return None
        q, known = (s.motion.q[s.motion.kept] for s in (self, other))
        even = np.arange(0.0, self.since[-1], other.pace)
        lag = lag_between(known, np.column_stack([np.interp(even, self.since, x) for x in q.T]))
        return None if lag is None else lag * other.pace

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
