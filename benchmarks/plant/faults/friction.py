"""Friction: MuJoCo's own dry friction and damping, with a level that may depend on the state.

Dry friction is MuJoCo's `frictionloss`, a constraint solved at each step: a joint truly sticks, and sgn needs
no smoothing. Where the level depends on speed, direction or load it is set anew at each step.
"""

from __future__ import annotations

from typing import ClassVar

import mujoco
import numpy as np

from benchmarks.plant.faults.mechanism import Mechanism, Parameters, Step


class CoulombFriction(Mechanism):
    """f = −level sgn q̇."""

    name = "coulomb_friction"
    defaults: ClassVar[Parameters] = {"level": 1.0}
    sizes = ("level",)

    def act(self, x: Step) -> None:
        """Act at one step."""
        x.loss[self.j] += self.amount * self.p["level"]


class ViscousFriction(Mechanism):
    """f = −coefficient q̇."""

    name = "viscous_friction"
    defaults: ClassVar[Parameters] = {"coefficient": 1.0}
    sizes = ("coefficient",)

    added = 0.0

    def present(self, amount: float) -> None:
        """Write a share of the fault into the model."""
        self.model.dof_damping[self.dof] += amount * self.p["coefficient"] - self.added
        self.added = amount * self.p["coefficient"]


class StribeckFriction(Mechanism):
    """f = −(level + breakaway exp(−decay |q̇|)) sgn q̇."""

    name = "stribeck_friction"
    defaults: ClassVar[Parameters] = {"level": 1.0, "breakaway": 1.0, "decay": 10.0}
    sizes = ("level", "breakaway")

    def act(self, x: Step) -> None:
        """Act at one step."""
        fall = np.exp(-self.p["decay"] * abs(x.v[self.j]))
        x.loss[self.j] += self.amount * (self.p["level"] + self.p["breakaway"] * fall)


class AsymmetricFriction(Mechanism):
    """f = −(level± sgn q̇ + coefficient± q̇), by direction."""

    name = "asymmetric_friction"
    defaults: ClassVar[Parameters] = {
        "level_positive": 1.0,
        "level_negative": 1.0,
        "coefficient_positive": 0.0,
        "coefficient_negative": 0.0,
    }
    sizes = tuple(defaults)

    def act(self, x: Step) -> None:
        """Act at one step."""
        v = x.v[self.j]
        way = "positive" if v > 0 else "negative"
        x.loss[self.j] += self.amount * self.p[f"level_{way}"]
        x.force[self.j] -= self.amount * self.p[f"coefficient_{way}"] * v


class QuadraticFriction(Mechanism):
    """f = −coefficient |q̇| q̇."""

    name = "quadratic_friction"
    defaults: ClassVar[Parameters] = {"coefficient": 1.0}
    sizes = ("coefficient",)

    def act(self, x: Step) -> None:
        """Act at one step."""
        v = x.v[self.j]
        x.force[self.j] -= self.amount * self.p["coefficient"] * abs(v) * v


class LoadFriction(Mechanism):
    """f = −coefficient |τ| sgn q̇, with the torque τ that the actuator delivers."""

    name = "load_friction"
    defaults: ClassVar[Parameters] = {"coefficient": 0.1}
    sizes = ("coefficient",)

    def act(self, x: Step) -> None:
        """Act at one step."""
        x.loss[self.j] += self.amount * self.p["coefficient"] * abs(x.delivered[self.j])


class CoupledFriction(Mechanism):
    """f = −coefficient s − level sgn s on both joints, s = q̇ᵢ + q̇ⱼ: a damped, rubbing tendon over both."""

    name = "coupled_friction"
    defaults: ClassVar[Parameters] = {"coefficient": 0.0, "level": 0.0}
    sizes = ("coefficient", "level")
    places = 2

    def edit(self, spec: mujoco.MjSpec, arm: object) -> None:
        """Add what the fault needs to the description."""
        self.tendon = f"plant/gear{len(list(spec.tendons))}"
        tendon = spec.add_tendon(name=self.tendon)
        for joint in self.fault.joints:
            tendon.wrap_joint(joint, 1.0)

    def present(self, amount: float) -> None:
        """Write a share of the fault into the model."""
        t = self.model.tendon(self.tendon).id
        self.model.tendon_damping[t] = amount * self.p["coefficient"]
        self.model.tendon_frictionloss[t] = amount * self.p["level"]
