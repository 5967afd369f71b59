"""Nominal control without any monitor: what an arm does that does not know of its faults."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.online.rigid_body import RigidBody
from benchmarks.plant.motion import Reference
from cdia_pin.robot import RobotModel

Array = NDArray[np.float64]

LAG = 0.005  # [s], time constant of the derivative where velocities are not measured


class NominalControl:
    """Computed torque τ = M [q̈_d − K_p (q − q_d) − K_v (q̇ − q̇_d)] + nle of the file's model.

    Without measured velocities it differentiates the positions, with a lag of 5 ms.

    Args:
        robot: The arm that the controller believes in.
        stiffness: K_p [1/s²].
        damping: K_v [1/s].
    """

    def __init__(self, robot: RobotModel, stiffness: float = 400.0, damping: float = 40.0) -> None:
        self.body = RigidBody(robot)
        self.stiffness, self.damping = stiffness, damping
        self._time, self._q, self._v = np.inf, np.empty(0), np.empty(0)

    def __call__(self, t: float, q: Array, v: Array | None, reference: Reference) -> Array:
        """Return the torque to command [N·m or N], shape (n,)."""
        if v is None:
            v = self._differentiated(t, q, reference)
        a = reference.a - self.stiffness * (q - reference.q) - self.damping * (v - reference.v)
        return self.body.inverse_dynamics(q, v, a)

    def _differentiated(self, t: float, q: Array, reference: Reference) -> Array:
        if t <= self._time:  # another run
            self._v = reference.v
        else:
            keep = np.exp(-(t - self._time) / LAG)
            self._v = keep * self._v + (1 - keep) * (q - self._q) / (t - self._time)
        self._time, self._q = t, q
        return self._v
