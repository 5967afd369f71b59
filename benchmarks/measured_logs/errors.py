"""Errors on a log that was not fitted, on all of its samples and on those in which a joint moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.measured_logs.cases import Case
from cdia_pin.dynamics import Dynamics
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.regression.experiment import Experiment, rms

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Column:
    """What one way of fitting leaves, RMS over the RMS torque of each joint [1].

    Attributes:
        name: What the tables call it.
        moving: On samples in which the joint moves, shape (n,).
        everywhere: On all samples, shape (n,); None where it was not computed.
        seconds: Processor time that it took [s]; NaN for none.
    """

    name: str
    moving: Array
    everywhere: Array | None = None
    seconds: float = float("nan")


@dataclass(frozen=True)
class Bench:
    """A case, filtered alike for everybody.

    Attributes:
        case: The logs.
        conditioning: Their filter.
        fitted: The log that is fitted.
        unseen: The log that is only predicted.
    """

    case: Case
    conditioning: Conditioning
    fitted: Experiment
    unseen: Experiment

    @classmethod
    def of(cls, case: Case, cutoff: float) -> Bench:
        """Filter the logs of a case at a cut-off [Hz]."""
        conditioning = Conditioning(cutoff=cutoff)
        fitted, unseen = (
            Experiment.of(case.robot, [condition(log, case.robot, conditioning)])
            for log in (case.fitted, case.unseen)
        )
        return cls(case, conditioning, fitted, unseen)

    def column(self, name: str, model: Dynamics, seconds: float = float("nan")) -> Column:
        """Return what a model leaves of the unseen log."""
        return self.left(name, self.unseen.predict(model).residual, seconds=seconds)

    def left(
        self, name: str, residual: Array, moving: Array | None = None, seconds: float = float("nan")
    ) -> Column:
        """Return a column of a residual of the unseen log.

        Args:
            name: What the tables call it.
            residual: Predicted less measured torque [N·m or N], shape (K, n).
            moving: The same of another fit, which is to be judged on moving samples.
            seconds: Processor time that it took [s].
        """
        everywhere = self._share(residual, np.ones_like(self.unseen.informative))
        own = self._share(residual if moving is None else moving, self.unseen.informative)
        return Column(name, own, everywhere, seconds)

    def step(self, name: str, errors: Array) -> Column:
        """Return a column of errors on moving samples [N·m or N], shape (n,)."""
        return Column(name, errors / rms(self.unseen.measured, self.unseen.informative))

    def _share(self, residual: Array, used: NDArray[np.bool_]) -> Array:
        return rms(residual, used) / rms(self.unseen.measured, used)
