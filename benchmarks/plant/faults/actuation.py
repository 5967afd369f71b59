"""Between the command and the joint: gains, offsets, rotors, springs, ripple."""

from __future__ import annotations

import numpy as np

from benchmarks.plant.faults.mechanism import Mechanism, Step


class ActuatorGain(Mechanism):
    """f = gain τ: the joint receives (1 + gain) times what is commanded and recorded."""

    name = "actuator_gain"
    defaults = {"gain": -0.2}
    sizes = ("gain",)

    def act(self, x: Step) -> None:
        x.delivered[self.j] += self.amount * self.p["gain"] * x.command[self.j]


class TorqueOffset(Mechanism):
    """f = offset."""

    name = "torque_offset"
    defaults = {"offset": 1.0}
    sizes = ("offset",)

    def act(self, x: Step) -> None:
        x.force[self.j] += self.amount * self.p["offset"]


class RotorInertia(Mechanism):
    """f = −inertia q̈: MuJoCo's armature."""

    name = "rotor_inertia"
    defaults = {"inertia": 0.1}
    sizes = ("inertia",)
    added = 0.0

    def present(self, amount: float) -> None:
        self.model.dof_armature[self.dof] += amount * self.p["inertia"] - self.added
        self.added = amount * self.p["inertia"]


class JointSpring(Mechanism):
    """f = −stiffness q + preload: MuJoCo's joint stiffness, its rest where both parts cancel."""

    name = "joint_spring"
    defaults = {"stiffness": 1.0, "preload": 0.0}
    sizes = ("stiffness", "preload")

    def present(self, amount: float) -> None:
        joint = self.model.dof_jntid[self.dof]
        k = self.p["stiffness"]
        self.model.jnt_stiffness[joint] = amount * k
        self.model.qpos_spring[self.model.jnt_qposadr[joint]] = self.p["preload"] / k if k else 0.0


class PositionRipple(Mechanism):
    """f = sine sin(frequency q) + cosine cos(frequency q)."""

    name = "position_ripple"
    defaults = {"sine": 1.0, "cosine": 0.0, "frequency": 7.0}
    sizes = ("sine", "cosine")

    def act(self, x: Step) -> None:
        phase = self.p["frequency"] * x.q[self.j]
        x.force[self.j] += self.amount * (self.p["sine"] * np.sin(phase) + self.p["cosine"] * np.cos(phase))
