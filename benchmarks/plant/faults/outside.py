"""Physics that no effect of the vocabulary describes: it should be reported as unexplained."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from benchmarks.plant.faults.mechanism import Mechanism, Parameters, Step


class CubicSpring(Mechanism):
    """f = −stiffness (q − rest)³."""

    name = "cubic_spring"
    defaults: ClassVar[Parameters] = {"stiffness": 1.0, "rest": 0.0}
    sizes = ("stiffness",)

    def act(self, x: Step) -> None:
        """Act at one step."""
        x.force[self.j] -= self.amount * self.p["stiffness"] * (x.q[self.j] - self.p["rest"]) ** 3


class TorqueDeadzone(Mechanism):
    """f = −clip(τ, ±width): a play in the drive swallows the first part of each torque."""

    name = "torque_deadzone"
    defaults: ClassVar[Parameters] = {"width": 1.0}
    sizes = ("width",)

    def act(self, x: Step) -> None:
        """Act at one step."""
        width = self.amount * self.p["width"]
        x.force[self.j] -= min(max(x.delivered[self.j], -width), width)


class SpeedCogging(Mechanism):
    """f = −coefficient sin(frequency q) q̇: a ripple that grows with speed."""

    name = "speed_cogging"
    defaults: ClassVar[Parameters] = {"coefficient": 1.0, "frequency": 7.0}
    sizes = ("coefficient",)

    def act(self, x: Step) -> None:
        """Act at one step."""
        ripple = np.sin(self.p["frequency"] * x.q[self.j])
        x.force[self.j] -= self.amount * self.p["coefficient"] * ripple * x.v[self.j]


class PostureFriction(Mechanism):
    """f = −level (1 + sin(2 q_other)) sgn q̇: dry friction that another joint's position sets."""

    name = "posture_friction"
    defaults: ClassVar[Parameters] = {"level": 1.0}
    sizes = ("level",)
    places = 2

    def act(self, x: Step) -> None:
        """Act at one step."""
        x.loss[self.j] += self.amount * self.p["level"] * (1 + np.sin(2 * x.q[self.other]))


class WarmingFriction(Mechanism):
    """f = −level exp(−t/time) sgn q̇: friction that falls as the gear warms."""

    name = "warming_friction"
    defaults: ClassVar[Parameters] = {"level": 1.0, "time": 12.0}
    sizes = ("level",)

    def act(self, x: Step) -> None:
        """Act at one step."""
        x.loss[self.j] += self.amount * self.p["level"] * np.exp(-max(x.t, 0.0) / self.p["time"])


class CrossSpring(Mechanism):
    """f = torque sin(2 q_other): a hose that another joint pulls."""

    name = "cross_spring"
    defaults: ClassVar[Parameters] = {"torque": 1.0}
    sizes = ("torque",)
    places = 2

    def act(self, x: Step) -> None:
        """Act at one step."""
        x.force[self.j] += self.amount * self.p["torque"] * np.sin(2 * x.q[self.other])


class Presliding(Mechanism):
    """Hysteresis of a bristle (Dahl, LuGre): f = −level z/reach, ż = q̇ − |q̇| z/reach.

    Torque follows displacement for about `reach` after each reversal, and is Coulomb's far from it.
    """

    name = "presliding"
    defaults: ClassVar[Parameters] = {"level": 1.0, "reach": 0.1}  # [N·m], [rad]
    sizes = ("level",)
    places = 1
    z = 0.0
    last = None

    def act(self, x: Step) -> None:
        """Act at one step."""
        q, reach = float(x.q[self.j]), self.p["reach"]
        moved = 0.0 if self.last is None else q - self.last
        self.z = (self.z + moved) / (1 + abs(moved) / reach)
        self.last = q
        x.force[self.j] -= self.amount * self.p["level"] * self.z / reach


class SpeedBump(Mechanism):
    """f = −level exp(−((|q̇| − speed)/width)²) sgn q̇: a resonance at one speed."""

    name = "speed_bump"
    defaults: ClassVar[Parameters] = {"level": 1.0, "speed": 0.5, "width": 0.1}
    sizes = ("level",)

    @property
    def damping(self) -> float:
        """Slope where the bump is steepest [N·m·s/rad or N·s/m]."""
        return float(abs(self.p["level"]) * np.sqrt(2 / np.e) / self.p["width"])

    def act(self, x: Step) -> None:
        """Act at one step."""
        v = x.v[self.j]
        bump = np.exp(-(((abs(v) - self.p["speed"]) / self.p["width"]) ** 2))
        x.force[self.j] -= self.amount * self.p["level"] * bump * np.tanh(v / 0.05)
