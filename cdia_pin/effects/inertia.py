"""Rigid bodies that are not as the URDF says: a wrong link, a tool bolted on or missing."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect, Parameter
from cdia_pin.effects.state import State
from cdia_pin.errors import EffectError
from cdia_pin.robot.inertia import from_pseudo_inertia, is_physical, pseudo_inertia, transform_parameters
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

MOMENTS = tuple(f"first_moment_{axis}" for axis in "xyz")
INERTIAS = tuple(f"inertia_{axes}" for axes in ("xx", "xy", "yy", "xz", "yz", "zz"))
BODY = (
    Parameter("mass", "kg"),
    *(Parameter(m, "kg·m") for m in MOMENTS),
    *(Parameter(i, "kg·m²") for i in INERTIAS),
)
SURPRISING_MASS = 5.0  # [kg], least scale of a body's prior
SURPRISING_REACH = 0.3  # [m], distance of its centre of mass, likewise
ROUNDING = 1e-5  # [1], smallest second moment of a possible body, relative to their sum
SLIGHT = 0.3  # share by which a link may differ where all of them do
USUAL = 0.05  # share by which links usually differ: what a motion does not tell is held to that
MOST_HALVINGS = 20  # of a change that leaves a link impossible, before it is dropped
LEAST_MASS = 0.02  # of the arm's mass: what a URDF gives to a link may be a placeholder
LEAST_RADIUS = 0.03  # [m], radius of gyration of a link, likewise


class Body(Effect):
    """A rigid body that is added to, or taken from, the link of a joint."""

    parameters = BODY
    of_acceleration: ClassVar[bool] = True
    weighs: ClassVar[bool] = True

    @property
    def bodies(self) -> tuple[Body, ...]:
        """The body itself."""
        return (self,)

    @abstractmethod
    def carrier(self, robot: RobotModel) -> int:
        """Return the index of the joint whose link the body is part of."""

    def to_joint_frame(self, robot: RobotModel) -> Array:
        """Return A with π_joint = A π, from the body's frame to that of the joint, shape (10, 10)."""
        return np.eye(10)

    def in_joint_frame(self, theta: Array, robot: RobotModel) -> Array:
        """Return the body's parameters about the frame of the carrying joint, shape (10,)."""
        return self.to_joint_frame(robot) @ theta

    def basis(self, x: State) -> Array:
        """Return −Y of a unit body, shape (N, n, 10)."""
        return -self._regressor(x) @ self.to_joint_frame(x.robot)

    def torque(self, x: State, theta: Array) -> Array:
        """Return f = −Y π [N·m or N] for the body θ = π, shape (N, n)."""
        return -self._regressor(x) @ self.in_joint_frame(theta, x.robot)

    def total(self, theta: Array, robot: RobotModel) -> Array:
        """Return the parameters of link and body together, about the joint's frame, shape (10,)."""
        return robot.inertial_parameters[self.carrier(robot)] + self.in_joint_frame(theta, robot)

    def is_physical(self, theta: Array, robot: RobotModel) -> bool:
        """Tell whether link and body together are a possible body."""
        return super().is_physical(theta, robot) and bool(is_physical(self.total(theta, robot), ROUNDING))

    def nearest_physical(self, theta: Array, robot: RobotModel) -> Array:
        """Return an estimate with mass and first moments kept and its inertia made possible, shape (10,).

        The mass is raised where it must be; second moments about the centre of mass lose what is negative.
        """
        if self.is_physical(theta, robot):
            return np.array(theta, float)
        lower, upper = self.bounds(robot)
        total = self.total(np.clip(theta, lower, upper), robot)
        link = robot.inertial_parameters[self.carrier(robot)]
        total[0] = max(total[0], 0.02 * link[0], 1e-3)
        pseudo = pseudo_inertia(total)
        moment = pseudo[:3, 3] / total[0]
        values, vectors = np.linalg.eigh(pseudo[:3, :3] - total[0] * np.outer(moment, moment))
        about_centre = vectors @ np.diag(np.maximum(values, 0.0)) @ vectors.T
        pseudo[:3, :3] = about_centre + total[0] * np.outer(moment, moment)
        return np.linalg.solve(self.to_joint_frame(robot), from_pseudo_inertia(pseudo) - link)

    def prior_scale(self, robot: RobotModel) -> Array:
        """Return the size of body that would surprise nobody: as heavy as its link, near its joint."""
        mass = max(SURPRISING_MASS, float(robot.inertial_parameters[self.carrier(robot)][0]))
        return np.array([mass] + [mass * SURPRISING_REACH] * 3 + [mass * SURPRISING_REACH**2] * 6)

    def _regressor(self, x: State) -> Array:
        return x.body_regressor(self.carrier(x.robot))


@dataclass(frozen=True)
class LinkInertia(Body):
    """The inertial parameters of the link moved by a joint differ from the URDF, f = −Y δπ [Wensing2018].

    The parameters are differences to the URDF, about the joint's frame. Several links that all differ slightly are one
    effect, written with their joints: link_inertia@JOINT+JOINT.

    Attributes:
        joint: Name of the joint that moves the link.
    """

    joint: str

    name: ClassVar[str] = "link_inertia"
    equation: ClassVar[str] = "−Y δπ"
    rarity: ClassVar[float] = 3.0  # a tool changes more often than a link
    scope_fields: ClassVar[tuple[str, ...]] = ("joint",)

    def carrier(self, robot: RobotModel) -> int:
        """Return the index of the joint."""
        return robot.joint_index(self.joint)

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return bounds that leave the link at least a twentieth of its mass."""
        lower, upper = super().bounds(robot)
        lower[0] = -0.95 * robot.inertial_parameters[self.carrier(robot)][0]
        return lower, upper

    @classmethod
    def scopes(cls, robot: RobotModel) -> Iterator[tuple[str, ...]]:
        """Yield every joint that moves a link."""
        yield from ((j,) for j in robot.joints)


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
    of_acceleration: ClassVar[bool] = True
    weighs: ClassVar[bool] = True
    slight: ClassVar[bool] = True
    rarity: ClassVar[float] = LinkInertia.rarity

    def __post_init__(self) -> None:
        if len(set(self.links)) < max(len(self.links), 2):
            raise EffectError(
                f"{self.label}: several links have different joints, given {', '.join(self.links)}"
            )
        named = (replace(p, name=f"{p.name}[{joint}]") for joint in self.links for p in BODY)
        object.__setattr__(self, "parameters", tuple(named))

    @property
    def bodies(self) -> tuple[Body, ...]:
        """Each link by itself."""
        return tuple(map(LinkInertia, self.links))

    @property
    def scope(self) -> tuple[str, ...]:
        """Joints that move the links."""
        return self.links

    def basis(self, x: State) -> Array:
        """Return −Y of a unit body on each link, shape (N, n, p)."""
        return -np.concatenate([x.body_regressor(j) for j in map(x.robot.joint_index, self.links)], axis=2)

    def torque(self, x: State, theta: Array) -> Array:
        """Return f = −Σ Yⱼ δπⱼ [N·m or N], shape (N, n)."""
        return np.sum([body.torque(x, part) for body, part in self.by_body(theta)], axis=0)

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return bounds within which each link is nearly as the URDF has it."""
        most = SLIGHT * self._sizes(robot)
        return -most, most

    def prior_scale(self, robot: RobotModel) -> Array:
        """Return by how much links usually differ."""
        return USUAL * self._sizes(robot)

    def is_physical(self, theta: Array, robot: RobotModel) -> bool:
        """Tell whether every link is a possible body."""
        possible = (body.is_physical(part, robot) for body, part in self.by_body(theta))
        return super().is_physical(theta, robot) and all(possible)

    def nearest_physical(self, theta: Array, robot: RobotModel) -> Array:
        """Return an estimate within the bounds, each change halved until its link is possible, shape (p,)."""
        near = np.clip(theta, *self.bounds(robot))
        for body, part in self.by_body(near):
            halvings = 0
            while not body.is_physical(part, robot):
                halvings += 1
                part[:] = 0.5 * part if halvings < MOST_HALVINGS else 0.0
        return near

    def _sizes(self, robot: RobotModel) -> Array:
        """Return mass, moments and inertias of each link, as large as they can be, shape (p,)."""
        out = []
        for joint in self.links:
            pseudo = pseudo_inertia(robot.inertial_parameters[robot.joint_index(joint)])
            mass = max(pseudo[3, 3], LEAST_MASS * robot.total_mass)
            reach = np.sqrt(max(np.trace(pseudo[:3, :3]) / mass, LEAST_RADIUS**2))
            out.append(mass * np.array([1.0] + [reach] * 3 + [reach**2] * 6))
        return np.concatenate(out)

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-ready description."""
        return {"effect": self.name, "joints": list(self.links)}

    @classmethod
    def from_scope(cls, scope: Sequence[str], shape: Mapping[str, Any]) -> Self:
        """Build the effect from joint names; it has no shape."""
        if shape:
            raise EffectError(f"{cls.name}: has no shape, given {', '.join(shape)}")
        return cls(tuple(scope))


@dataclass(frozen=True)
class Payload(Body):
    """A rigid body on the tool, f = −Y_tool π [Wensing2018].

    The parameters are about the tool frame. A negative mass means that the real arm lacks a tool which the
    URDF carries; link and payload together stay a possible body.
    """

    name: ClassVar[str] = "payload"
    equation: ClassVar[str] = "−Y_tool π"

    def carrier(self, robot: RobotModel) -> int:
        """Return the index of the joint that moves the tool."""
        return robot.joint_index(robot.tool_joint)

    def to_joint_frame(self, robot: RobotModel) -> Array:
        """Return A with π_joint = A π: from the tool frame to that of the tool's joint, shape (10, 10)."""
        return _tool_transform(robot)

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return bounds that take away no more mass than the URDF carries on the tool's link."""
        lower, upper = super().bounds(robot)
        lower[0] = -0.98 * robot.inertial_parameters[self.carrier(robot)][0]
        return lower, upper


@lru_cache(maxsize=32)
def _tool_transform(robot: RobotModel) -> Array:
    return transform_parameters(robot.tool_placement)
