"""A fault that no known effect explains, learned as radial bases in q and q̇ and a torque neuron ([Thesis] eq. 3.1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.learning import Healthy
from cdia_pin.effects import Unknown

Array = NDArray[np.float64]

WIDEST = 10.0  # [rad or m, and per s], range of a signal that nothing limits
RIDGE = 1e-3  # [1], of the weights, relative to the mean energy of their columns: keeps them bounded


def neurons_of(joint: str, reach: Array, count: int) -> Unknown:
    """Return neurons spread over what a joint does.

    Args:
        joint: Name of the joint.
        reach: Smallest and largest position, then velocity, shape (2, 2).
        count: Neurons in position, and in velocity.
    """
    (q0, q1), (v0, v1) = np.clip(reach, -WIDEST, WIDEST)
    q = np.linspace(q0, max(q1, q0 + 1e-3), max(count, 2))
    v = np.linspace(v0, max(v1, v0 + 1e-3), max(count, 2))
    return Unknown(
        joint=joint,
        position_centres=tuple(q.tolist()),
        velocity_centres=tuple(v.tolist()),
        position_width=float(1.5 * (q[1] - q[0])),
        velocity_width=float(1.5 * (v[1] - v[0])),
    )


def weights(gram: Array) -> Array:
    """Return the weights of the neurons that explain a residual, shape (p,).

    Args:
        gram: Gram matrix of the neurons and of what is left to them, upper triangle, shape (p + 1, p + 1).
    """
    part = np.triu(gram)
    full = part + np.triu(part, 1).T
    G, g = full[:-1, :-1], full[:-1, -1]
    if not np.trace(G) > 0.0:
        return np.zeros(len(g))
    # one size of ridge for all: a neuron that has hardly been visited stays near zero
    return np.asarray(np.linalg.solve(G + RIDGE * np.trace(G) / len(g) * np.eye(len(g)), g))


def unknown_of(healthy: Healthy, j: int, count: int) -> Unknown:
    """Return the neurons of a joint over the reach of the healthy runs."""
    return neurons_of(healthy.nominal.robot.joints[j], healthy.reach[:, :, j], count)
