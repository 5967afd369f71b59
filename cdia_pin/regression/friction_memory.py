"""Friction with memory: after a reversal the torque depends on the distance travelled, not on the direction alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.regression.experiment import Experiment

Array = NDArray[np.float64]


def bristle(position: Array, reach: float) -> Array:
    r"""Return the deflection of the bristles of a joint, −1 to 1 [1], shape (N,).

    Dahl's model, :math:`\mathrm{d}z = (\operatorname{sgn}\dot q - z)\,|\mathrm{d}q| / r`: after a reversal z changes
    its sign over a distance of about r; far from a reversal it is sgn q̇ [Armstrong1994].

    Args:
        position: Position along a log [rad or m], shape (N,).
        reach: r [rad or m].
    """
    step = np.diff(position, prepend=position[0])
    decay, direction = np.exp(-np.abs(step) / reach), np.sign(step)
    z, out = 0.0, np.empty(len(position))
    for k, (d, s) in enumerate(zip(decay.tolist(), direction.tolist(), strict=True)):
        z = out[k] = s + (z - s) * d
    return out


def bent(experiment: Experiment, j: int, reach: float) -> Array:
    """Return the deflection of the bristles of a joint [1], filtered like the torques, shape (K,).

    Args:
        experiment: The logs.
        j: Index of the joint.
        reach: Distance of the build-up r [rad or m].
    """
    return experiment.compared(lambda m: bristle(m.q[:, j], reach))
