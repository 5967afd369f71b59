"""What another tool makes of a log, in terms that can be compared."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.robot import RobotModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Answer:
    """A fitted model.

    Attributes:
        named: The effects that it says are there, by our labels.
        torque: From q, q̇, q̈ of shape (N, n) to the torque that it predicts [N·m or N], shape (N, n).
    """

    named: tuple[str, ...]
    torque: Callable[[Array, Array, Array], Array]

    def error(self, robot: RobotModel, log: Log) -> Array:
        """Return what it leaves of a log under our conditioning, RMS [N·m or N], shape (n,)."""
        experiment = Experiment.of(robot, [condition(log, robot)])
        (segment,) = experiment.segments
        m = segment.motion
        return rms(m.compared(self.torque(m.q, m.v, m.a) - m.effort), experiment.informative)
