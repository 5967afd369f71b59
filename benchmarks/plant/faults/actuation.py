"""Between the command and the joint: gains, offsets, rotors, springs, ripple."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from benchmarks.plant.faults.mechanism import Mechanism, Parameters, Step


class ActuatorGain(Mechanism):
    """f = gain τ: the joint receives (1 + gain) times what is commanded and recorded."""

    name = "actuator_gain"
    defaults: ClassVar[Parameters] = {"gain": -0.2}
    sizes = ("gain",)

    def act(self, x: Step) -> None:
        """Act at one step."""
        x.delivered[self.j] += self.amount * self.p["gain"] * x.command[self.j]


class TorqueOffset(Mechanism):
    """f = offset."""

    name = "torque_offset"
    defaults: ClassVar[Parameters] = {"offset": 1.0}
    sizes = ("offset",)

    def act(self, x: Step) -> None:
        """Act at one step."""
        x.force[self.j] += self.amount * self.p["offset"]


class RotorInertia(Mechanism):
    """f = −inertia q̈: MuJoCo's armature."""

    name = "rotor_inertia"
    defaults: ClassVar[Parameters] = {"inertia": 0.1}
    sizes = ("inertia",)
    added = 0.0

    def present(self, amount: float) -> None:
        """Write a share of the fault into the model."""
        self.model.dof_armature[self.dof] += amount * self.p["inertia"] - self.added
        self.added = amount * self.p["inertia"]


class JointSpring(Mechanism):
    """f = −stiffness q + preload: MuJoCo's joint stiffness, its rest where both parts cancel."""

    name = "joint_spring"
    defaults: ClassVar[Parameters] = {"stiffness": 1.0, "preload": 0.0}
    sizes = ("stiffness", "preload")
    added = 0.0

    def present(self, amount: float) -> None:
        """Write a share of the fault into the model, beside the other springs of the joint."""
        joint = self.model.dof_jntid[self.dof]
        at = self.model.jnt_qposadr[joint]
        k, more = self.model.jnt_stiffness[joint], amount - self.added
        preload = k * self.model.qpos_spring[at] + more * self.p["preload"]
        self.model.jnt_stiffness[joint] = stiffness = k + more * self.p["stiffness"]
        self.model.qpos_spring[at] = preload / stiffness if stiffness else 0.0
        self.added = amount


class PositionRipple(Mechanism):
    """f = sine sin(frequency q) + cosine cos(frequency q)."""

    name = "position_ripple"
    defaults: ClassVar[Parameters] = {"sine": 1.0, "cosine": 0.0, "frequency": 7.0}
    sizes = ("sine", "cosine")

    def act(self, x: Step) -> None:
        """Act at one step."""
        phase = self.p["frequency"] * x.q[self.j]
        x.force[self.j] += self.amount * (self.p["sine"] * np.sin(phase) + self.p["cosine"] * np.cos(phase))
