"""Links that all differ slightly from the URDF, as one effect."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.body import BODY, Body
from cdia_pin.effects.effect import Effect
from cdia_pin.effects.inertia import LinkInertia
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.plausibility import Plausibility
from cdia_pin.effects.records import EffectRecord
from cdia_pin.effects.state import State
from cdia_pin.effects.traits import Traits
from cdia_pin.errors import EffectError
from cdia_pin.robot.inertia import pseudo_inertia
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

LARGEST_SHARE = 0.3  # [1], of its size by which a link may differ; what differs more is one wrong link
USUAL_SHARE = 0.05  # [1], standard deviation of that share: CAD masses are hardly better
MOST_HALVINGS = 20  # of a change that leaves a link impossible, before it is dropped
LEAST_MASS = 0.02  # [1], of the arm's mass: a URDF's mass of a link may be a placeholder
LEAST_RADIUS = 0.03  # [m], radius of gyration of a link, likewise


@dataclass(frozen=True)
class LinkInertias(Effect):
    """The inertial parameters of several links differ slightly from the URDF, f = −Σ Yⱼ δπⱼ [Wensing2018].

    The parameters are those of `LinkInertia`, of one link after another. No link differs by more than a share of its
    mass and reach: what is larger is one wrong link, or a payload.

    Attributes:
        links: Names of the joints that move the links, two at least.
    """

    links: tuple[str, ...]

    name: ClassVar[str] = "link_inertia"
    equation: ClassVar[str] = "−Σ Yⱼ δπⱼ"
    traits: ClassVar[Traits] = Body.traits
    plausibility: ClassVar[Plausibility] = replace(LinkInertia.plausibility, collective=True)

    def __post_init__(self) -> None:
        if len(set(self.links)) < max(len(self.links), 2):
            raise EffectError(
                f"{self.label}: several links have different joints, given {', '.join(self.links)}"
            )

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:  # type: ignore[override]
        """The parameters of each link, one link after another."""
        return tuple(replace(p, name=f"{p.name}[{joint}]") for joint in self.links for p in BODY)

    @property
    def bodies(self) -> tuple[LinkInertia, ...]:
        """Each link by itself."""
        return tuple(map(LinkInertia, self.links))

    def by_body(self, theta: Array) -> Iterator[tuple[LinkInertia, Array]]:
        """Yield each link with its own of the parameters θ (p,), shape (10,), a view of them.

        Args:
            theta: Parameters θ, shape (p,).
        """
        yield from zip(self.bodies, theta.reshape(len(self.links), -1), strict=True)

    @property
    def scope(self) -> tuple[str, ...]:
        """Joints that move the links."""
        return self.links

    def basis(self, x: State) -> Array:
        """Return −Y of a unit body on each link, shape (N, n, p).

        Args:
            x: Motion and torques, N samples.
        """
        return -np.concatenate([x.body_regressor(j) for j in map(x.robot.joint_index, self.links)], axis=2)

    def torque(self, x: State, theta: Array) -> Array:
        """Return f = −Σ Yⱼ δπⱼ [N·m or N], shape (N, n).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        return np.asarray(np.sum([body.torque(x, part) for body, part in self.by_body(theta)], axis=0))

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return bounds within which each link is nearly as the URDF has it.

        Args:
            robot: The arm, n joints.
        """
        most = LARGEST_SHARE * self._sizes(robot)
        return -most, most

    def prior_scale(self, robot: RobotModel) -> Array:
        """Return by how much links usually differ.

        Args:
            robot: The arm, n joints.
        """
        return USUAL_SHARE * self._sizes(robot)

    def is_physical(self, theta: Array, robot: RobotModel) -> bool:
        """Tell whether every link is a possible body.

        Args:
            theta: Parameters θ, shape (p,).
            robot: The arm, n joints.
        """
        possible = (body.is_physical(part, robot) for body, part in self.by_body(theta))
        return super().is_physical(theta, robot) and all(possible)

    def nearest_physical(self, theta: Array, robot: RobotModel) -> Array:
        """Return an estimate within the bounds, each change halved until its link is possible, shape (p,).

        Where the URDF's own link is no possible body, the change is what makes it one, as far as the bounds allow.

        Args:
            theta: Parameters θ, shape (p,).
            robot: The arm, n joints.
        """
        near = np.clip(theta, *self.bounds(robot))
        for body, part in self.by_body(near):
            for _ in range(MOST_HALVINGS):
                if body.is_physical(part, robot):
                    break
                part[:] = 0.5 * part
            else:
                part[:] = body.nearest_physical(np.zeros(len(part)), robot)
        return np.clip(near, *self.bounds(robot))

    def _sizes(self, robot: RobotModel) -> Array:
        """Return mass, moments and inertias of each link, as large as they can be, shape (p,)."""
        out = []
        for joint in self.links:
            pseudo = pseudo_inertia(robot.inertial_parameters[robot.joint_index(joint)])
            mass = max(pseudo[3, 3], LEAST_MASS * robot.total_mass)
            reach = np.sqrt(max(np.trace(pseudo[:3, :3]) / mass, LEAST_RADIUS**2))
            out.append(mass * np.array([1.0] + [reach] * 3 + [reach**2] * 6))
        return np.concatenate(out)

    def to_dict(self) -> EffectRecord:
        """Return a JSON-ready description."""
        return {"effect": self.name, "joints": list(self.links)}

    @classmethod
    def from_scope(cls, scope: Sequence[str], shape: Mapping[str, Any]) -> Self:
        """Build the effect from joint names; it has no shape.

        Args:
            scope: Names of the joints that move the links.
            shape: Nothing.
        """
        if shape:
            raise EffectError(f"{cls.name}: has no shape, given {', '.join(shape)}")
        return cls(tuple(scope))
