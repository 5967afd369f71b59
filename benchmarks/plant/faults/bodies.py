"""Rigid bodies that the URDF does not know, or knows wrongly."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import mujoco
import numpy as np

from benchmarks.plant.faults.mechanism import Mechanism, Parameters
from benchmarks.plant.urdf import LinkInertia as Body
from benchmarks.plant.urdf import read_inertia, write_inertia
from cdia_pin.errors import EffectError

if TYPE_CHECKING:
    from benchmarks.plant.arm import Arm


class Payload(Mechanism):
    """A homogeneous box or ball on the tool: a body of its own, welded to the tool's link.

    `com` is the centre in the tool's frame [m]; `size` the box's edges [m], or the ball's diameter.
    """

    name = "payload"
    defaults: ClassVar[Parameters] = {"mass": 1.0, "com": (0.0, 0.0, 0.05), "size": 0.1}
    sizes = ("mass",)
    places = 0

    def edit(self, spec: mujoco.MjSpec, arm: Arm) -> None:
        """Add what the fault needs to the description."""
        self.body = f"plant/payload{len(list(spec.bodies))}"
        body = spec.body(arm.tool).add_body(name=self.body, pos=self.p["com"])
        body.mass, body.inertia, body.explicitinertial = 1.0, [1.0, 1.0, 1.0], True
        body.ipos, body.iquat = (
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0, 0.0],
        )  # unset, MuJoCo repeats the body's own place

    def present(self, amount: float) -> None:
        """Write a share of the fault into the model."""
        b = self.model.body(self.body).id
        self.model.body_mass[b] = amount * self.p["mass"]
        self.model.body_inertia[b] = amount * self.p["mass"] * inertia_per_mass(self.p["size"])
        self.arm.refresh()


class LinkInertia(Mechanism):
    """A link of the arm is heavier, its mass elsewhere, or its inertia larger than the URDF says.

    `mass` [kg] and `com` [m, axes of the link] are added to the URDF's, `inertia` is the share added to its
    tensor about the centre of mass. The link is the heaviest that the joint moves as one, or `link`.
    """

    name = "link_inertia"
    defaults: ClassVar[Parameters] = {"mass": 0.0, "com": (0.0, 0.0, 0.0), "inertia": 0.0, "link": None}
    sizes = ("mass", "inertia")

    def found(self) -> None:
        """Note what the model holds before the fault."""
        assert self.fault.joint is not None
        self.body = self.model.body(self.p["link"] or self._heaviest(self.fault.joint)).id
        self.stated = read_inertia(self.model, self.body)
        if self.stated.mass + self.p["mass"] <= 0:
            raise EffectError(
                f"plant, link_inertia: the link weighs {self.stated.mass:g} kg, cannot lose more"
            )

    def present(self, amount: float) -> None:
        """Write a share of the fault into the model."""
        s = self.stated
        changed = Body(
            s.mass + amount * self.p["mass"],
            s.com + amount * np.asarray(self.p["com"]),
            s.tensor * (1 + amount * self.p["inertia"]),
        )
        write_inertia(self.model, self.body, changed)
        self.arm.refresh()

    def _heaviest(self, joint: str) -> str:
        bodies = self.arm.bodies_of(joint)
        return str(self.model.body(max(bodies, key=lambda b: self.model.body_mass[b])).name)


def inertia_per_mass(size: float | tuple[float, ...]) -> np.ndarray:
    """Return the principal moments of a ball or box of 1 kg about its centre [m²], shape (3,)."""
    if isinstance(size, float):
        return np.full(3, 0.4 * (size / 2) ** 2)
    x, y, z = (e**2 for e in size)
    return np.array([y + z, x + z, x + y]) / 12
