"""The nominal model as Pinocchio has it, without what the package puts around it: quick, and apart from it."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from cdia_pin.robot import RobotModel

Array = NDArray[np.float64]


class RigidBody:
    """M(q) q̈ + C(q, q̇) q̇ + g(q) = τ of a robot's file.

    Args:
        robot: Whose file, joints that are held, and gravity.
    """

    def __init__(self, robot: RobotModel) -> None:
        whole = pin.buildModelFromUrdf(str(robot.urdf))
        held, q0 = [whole.getJointId(name) for name in robot.locked], pin.neutral(whole)
        for joint, lock in zip(held, robot.locked.values(), strict=True):
            kind, p = whole.joints[joint], lock.position
            q0[kind.idx_q : kind.idx_q + kind.nq] = [p] if kind.nq == 1 else [np.cos(p), np.sin(p)]
        self.model = pin.buildReducedModel(whole, held, q0)
        self.model.gravity.linear = robot.gravity_vector
        self.data = self.model.createData()
        joints = [self.model.joints[i] for i in range(1, self.model.njoints)]
        self._plain = self.model.nq == self.model.nv
        self._starts = np.array([j.idx_q for j in joints])
        self._turns = np.array([j.nq == 2 for j in joints])  # endlessly: Pinocchio has its cosine and sine

    def configuration(self, q: Array) -> Array:
        """Return Pinocchio's configuration of joint positions, shape (nq,)."""
        if self._plain:
            return q
        out = np.empty(self.model.nq)
        out[self._starts] = np.where(self._turns, np.cos(q), q)
        out[self._starts[self._turns] + 1] = np.sin(q[self._turns])
        return out

    def inverse_dynamics(self, q: Array, v: Array, a: Array) -> Array:
        """Return the torque that a motion takes [N·m or N], shape (n,)."""
        return pin.rnea(self.model, self.data, self.configuration(q), v, a)

    def momentum_terms(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Return the momentum p = M q̇ and the torque Cᵀq̇ − g, shape (n,) each; ṗ = τ + f + Cᵀq̇ − g."""
        at = self.configuration(q)
        momentum = pin.crba(self.model, self.data, at) @ v
        coriolis = pin.computeCoriolisMatrix(self.model, self.data, at, v)
        return momentum, coriolis.T @ v - pin.computeGeneralizedGravity(self.model, self.data, at)
