"""Friction with memory: after a reversal, torque follows the distance travelled, not the direction alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.regression.experiment import Experiment

Array = NDArray[np.float64]


def bristle(position: Array, reach: float) -> Array:
    r"""Return how far the bristles of a joint are bent, −1 to 1, shape (N,).

    Dahl's model, :math:`\mathrm{d}z = (\operatorname{sgn}\dot q - z)\,|\mathrm{d}q| / r`: after a reversal z goes
    from one direction to the other over a distance of about r, and is sgn q̇ far from it [Armstrong1994].

    Args:
        position: Along a log [rad or m], shape (N,).
        reach: r, in the unit of the position.
    """
    step = np.diff(position, prepend=position[0])
    decay, direction = np.exp(-np.abs(step) / reach), np.sign(step)
    z, out = 0.0, np.empty(len(position))
    for k, (d, s) in enumerate(zip(decay.tolist(), direction.tolist(), strict=True)):
        z = out[k] = s + (z - s) * d
    return out


def bent(experiment: Experiment, j: int, reach: float) -> Array:
    """Return how far the bristles of a joint are bent, filtered as torques are, shape (K,).

    Args:
        experiment: The logs.
        j: Index of the joint.
        reach: In the unit of its position.
    """
    return experiment.compared(lambda m: bristle(m.q[:, j], reach))
