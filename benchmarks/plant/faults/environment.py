"""What surrounds the arm: its mounting, a pull on the tool, a fluid."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import mujoco
import numpy as np

from benchmarks.plant.faults.mechanism import Mechanism, Parameters, Step
from benchmarks.plant.urdf import TOOL_BODY

if TYPE_CHECKING:
    from benchmarks.plant.arm import Arm


class BaseTilt(Mechanism):
    """Gravity of the same size with the parts tilt_x, tilt_y across: MuJoCo's gravity, rotated."""

    name = "base_tilt"
    defaults: ClassVar[Parameters] = {"tilt_x": 0.0, "tilt_y": 0.0}  # [m/s²]
    sizes = ("tilt_x", "tilt_y")
    places = 0

    def found(self) -> None:
        """Note what the model holds before the fault."""
        self.stated = self.model.opt.gravity.copy()

    def present(self, amount: float) -> None:
        """Write a share of the fault into the model."""
        across = amount * np.array([self.p["tilt_x"], self.p["tilt_y"], 0.0])
        size = np.linalg.norm(self.stated)
        self.model.opt.gravity[:] = across + self.stated / size * np.sqrt(size**2 - across @ across)


class ToolWrench(Mechanism):
    """f = Jᵀ F: a constant force [N] and torque [N·m] at the tool's frame, in the axes of the base."""

    name = "tool_wrench"
    defaults: ClassVar[Parameters] = {"force": (0.0, 0.0, 0.0), "torque": (0.0, 0.0, 0.0)}
    sizes = ("force", "torque")
    places = 0
    added = 0.0

    def present(self, amount: float) -> None:
        """Write a share of the fault into the model."""
        wrench = self.arm.data.xfrc_applied[self.model.body(TOOL_BODY).id]
        wrench += (amount - self.added) * np.array([*self.p["force"], *self.p["torque"]])
        self.added = amount


class ViscousMedium(Mechanism):
    """A fluid: drag on each moving link's centre of mass, and buoyancy, both shared by mass.

    f = −drag Σ (mₗ/m) JₗᵀJₗ q̇ + (displaced_mass/m) G. Buoyancy is MuJoCo's gravity compensation.
    """

    name = "viscous_medium"
    defaults: ClassVar[Parameters] = {"drag": 0.0, "displaced_mass": 0.0}  # [N·s/m], [kg]
    sizes = ("drag", "displaced_mass")
    places = 0
    moving = True

    def edit(self, spec: mujoco.MjSpec, arm: Arm) -> None:
        """Add what the fault needs to the description."""
        for link in arm.links:
            spec.body(link).gravcomp = 1e-9  # MuJoCo skips the computation where every body has zero

    def found(self) -> None:
        """Note what the model holds before the fault."""
        m, rigid = self.model, mujoco.MjData(self.model)
        mujoco.mj_kinematics(m, rigid)
        self.bodies, masses, centres = [], [], []
        for joint in self.arm.joints:
            parts = self.arm.bodies_of(joint)
            weight = m.body_mass[parts]
            if weight.sum() > 0:
                first = parts[0]  # the link itself; what is welded to it moves with it
                from_first = weight @ rigid.xipos[parts] / weight.sum() - rigid.xpos[first]
                self.bodies.append(first)
                masses.append(weight.sum())
                centres.append(rigid.xmat[first].reshape(3, 3).T @ from_first)
        self.centres = np.array(centres)  # [m], in the axes of the body, (L, 3)
        self.shares = np.repeat(np.array(masses) / np.sum(masses), 3)  # one for each row of the Jacobians
        self.whole = float(np.sum(masses))
        self.jacobian = np.zeros((3 * len(masses), m.nv))
        self.all = [b for joint in self.arm.joints for b in self.arm.bodies_of(joint)]

    def present(self, amount: float) -> None:
        """Write a share of the fault into the model."""
        self.amount = amount
        self.model.body_gravcomp[self.all] = amount * self.p["displaced_mass"] / self.whole

    def act_moving(self, x: Step) -> None:
        """Act at one step, with the bodies where they are now."""
        m, d, J = self.model, self.arm.data, self.jacobian
        turned = np.einsum("lij,lj->li", d.xmat[self.bodies].reshape(-1, 3, 3), self.centres)
        points = d.xpos[self.bodies] + turned
        for row, body in enumerate(self.bodies):
            mujoco.mj_jac(m, d, J[3 * row : 3 * row + 3], None, points[row], body)
        speeds = J[:, self.arm.dofs] @ x.v
        x.force -= self.amount * self.p["drag"] * (self.shares * speeds) @ J[:, self.arm.dofs]
