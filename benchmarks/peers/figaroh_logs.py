"""figaroh: all base parameters, friction, rotors and offsets of all joints at once; it names no effect."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.peers.answer import Answer
from benchmarks.peers.figaroh_process import PYTHON, ask
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.experiment import Experiment
from cdia_pin.robot import RobotModel

Array = NDArray[np.float64]

if not PYTHON:
    raise ImportError("figaroh: CDIA_FIGAROH_PYTHON does not name an interpreter")


def fit(robot: RobotModel, log: Log) -> Answer:
    """Fit a log; the fit is made again for each motion that is predicted, since its script keeps none."""
    (segment,) = Experiment.of(robot, [condition(log, robot)]).segments

    def predicted(q: Array, v: Array, a: Array) -> Array:
        told, _ = ask(PYTHON, robot, segment, q, v, a)
        return told.get("physical", told["base"])

    predicted(segment.motion.q, segment.motion.v, segment.motion.a)  # what a user waits for
    return Answer((), predicted)
