"""Friction with memory as a function of the motion, for fits that do not name it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.presliding import deflection
from cdia_pin.regression.experiment import Experiment

Array = NDArray[np.float64]


def bent(experiment: Experiment, j: int, reach: float) -> Array:
    """Return the deflection of the bristles of a joint [1], filtered like the torques, shape (K,).

    Args:
        experiment: The logs.
        j: Index of the joint.
        reach: Distance of the build-up [rad or m], see `PreslidingFriction`.
    """
    return experiment.compared(lambda m: deflection(np.diff(m.q[:, j]), reach))
