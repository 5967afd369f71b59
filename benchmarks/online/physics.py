"""One physical step of the arm under a torque, and what the faults contribute to it.

The integration is the leapfrog of `benchmarks.plant.simulate`, on MuJoCo's own arrays to be quick:

    a = forward dynamics at (q, v, τ);   half += h a;   q += h half;   v = half + h/2 a
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks.plant.arm import Arm
from benchmarks.plant.faults import Mechanism, Step
from benchmarks.plant.simulate import NOTHING, POSITION
from cdia_pin.errors import RobotError

Array = NDArray[np.float64]


class Physics:
    """The arm in motion; `q`, `v` and `a` are MuJoCo's arrays, which change with each step.

    Args:
        arm: The compiled arm, mechanisms attached, its degrees of freedom in the order of its joints.
        mechanisms: The faults.
        q: Positions at which it rests at first [rad or m], shape (n,).
        step: Integration step h [s].
    """

    def __init__(self, arm: Arm, mechanisms: Sequence[Mechanism], q: Array, step: float) -> None:
        if not np.array_equal(arm.dofs, np.arange(arm.n)):
            raise RobotError(f"online plant: joints must be in the order of the tree, given {arm.joints}")
        self.model, self.data, self.step = arm.model, arm.data, step
        d = self.data
        d.qpos[:], d.qvel[:] = q, 0.0
        # Views: each access through MuJoCo's bindings costs more than an addition.
        self.q, self.v, self.a = d.qpos, d.qvel, d.qacc
        self._applied, self._passive, self._constraint = d.qfrc_applied, d.qfrc_passive, d.qfrc_constraint
        self._armature = arm.model.dof_armature
        self._half = np.zeros(arm.n)  # velocity half a step ago [rad/s or m/s]
        # Mechanisms write the level of dry friction where MuJoCo reads it.
        command, delivered, force = np.zeros((3, arm.n))
        self._x = Step(0.0, self.q, self.v, command, delivered, force, arm.model.dof_frictionloss)
        # What reaches the joint must be known to the mechanisms that depend on it.
        self._mechanisms = sorted(mechanisms, key=lambda k: k.name != "actuator_gain")
        self._moving = [k for k in mechanisms if k.moving]
        self._amounts = {k: k.fault.share(0.0) for k in mechanisms}
        for k, amount in self._amounts.items():
            k.present(amount)
        self._changing = [k for k, amount in self._amounts.items() if amount < 1.0 or k.fault.until < np.inf]

    def respond(self, t: float, arrived: Array) -> None:
        """Find the acceleration under the torque [N·m or N] that reaches the drives at a time [s], shape (n,)."""
        if not self._mechanisms:
            self._applied[:] = arrived
            mujoco.mj_forwardSkip(self.model, self.data, NOTHING, 1)
            return
        x = self._x
        x.t, x.command = t, arrived
        for k in self._changing:
            if self._amounts[k] != (amount := k.fault.share(t)):
                k.present(amount)
                self._amounts[k] = amount
        x.delivered[:] = arrived
        x.force[:] = 0.0
        x.loss[:] = 0.0
        for k in self._mechanisms:
            k.act(x)
        if self._moving:
            mujoco.mj_fwdPosition(self.model, self.data)
            for k in self._moving:
                k.act_moving(x)
        np.add(x.delivered, x.force, out=self._applied)
        mujoco.mj_forwardSkip(self.model, self.data, POSITION if self._moving else NOTHING, 1)

    def fault_torque(self, arrived: Array) -> Array:
        """Return f = M q̈ + nle − τ of the faults on joints, as MuJoCo applied it [N·m or N], shape (n,).

        What the drives and the mechanisms added, damping and springs, dry friction, and rotors.
        """
        added = self._applied - arrived
        added += self._passive
        added += self._constraint
        added -= self._armature * self.a
        return added

    def integrate(self) -> None:
        """Go one step further."""
        h, half, a = self.step, self._half, self.a
        half += h * a
        self.q += h * half
        np.add(half, (0.5 * h) * a, out=self.v)
