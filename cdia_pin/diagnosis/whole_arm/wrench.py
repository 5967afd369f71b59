"""Where an arm is touched, and how hard: the link and the force that explain the torques best."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RIDGE = 1e-3  # [1], added to the scaled normal equations: a link near the base shows one direction of a force only


class Touch(NamedTuple):
    """A force on a link.

    Attributes:
        link: Index of the joint that moves the link.
        force: The force on the arm in base axes [N], shape (3,).
        misfit: Mean square of what it leaves of the torques, over their scale [1].
    """

    link: int
    force: Array
    misfit: float


def located(torque: Array, scale: Array, jacobians: Array) -> Touch:
    """Return the link and the force that explain torques best.

    Args:
        torque: Torques that the arm lacks suddenly [N·m or N], shape (n,).
        scale: Size of a torque that means nothing [N·m or N], shape (n,).
        jacobians: Of the far ends of the links, linear rows first, shape (n, 6, n).
    """
    wanted = torque / scale
    best: Touch | None = None
    for link in range(len(torque)):
        J = (jacobians[link, :3] / scale).T  # (n, 3)
        A = J.T @ J
        force = np.linalg.solve(A + (RIDGE * np.trace(A) + 1e-12) * np.eye(3), J.T @ wanted)
        misfit = float(np.mean((wanted - J @ force) ** 2))
        if best is None or misfit < best.misfit:
            best = Touch(link, force, misfit)
    assert best is not None
    return best
