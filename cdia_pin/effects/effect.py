r"""The contract of an effect: physics of unknown size, written once and used in four roles.

An effect adds torque on the right of :math:`M \ddot q + \mathrm{nle} = \tau + f` with

.. math:: f = \Phi(x; s)\,\theta

It is a fault in a simulated plant, a hypothesis of an isolation bank, a candidate for what a model lacks
in a log, and a part of an improved model, without knowing which.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from numbers import Real
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.state import State
from cdia_pin.errors import EffectError, unknown_name
from cdia_pin.robot.model import RobotModel

if TYPE_CHECKING:
    from cdia_pin.effects.inertia import Body

Array = NDArray[np.float64]
INF = float("inf")


@dataclass(frozen=True)
class Parameter:
    """A number of an effect.

    Attributes:
        name: Name, as used in messages and files.
        unit: Unit; ``{effort}``, ``{position}`` and ``{inertia}`` become N·m, rad, kg·m² on a revolute joint
            and N, m, kg on a prismatic one.
        lower: Smallest physical value.
        upper: Largest physical value.
    """

    name: str
    unit: str
    lower: float = -INF
    upper: float = INF


class Effect(ABC):
    """Base of all effects: a subclass states its parameters and its basis Φ, nothing else.

    Subclasses are frozen dataclasses; their fields are the scope (a joint, two joints, or nothing for the
    whole arm) and the shape parameters s. Its class variables are promises that the contract tests hold.
    """

    name: ClassVar[str]
    equation: ClassVar[str]
    parameters: tuple[Parameter, ...]
    shape: ClassVar[tuple[Parameter, ...]] = ()
    scope_fields: ClassVar[tuple[str, ...]] = ()
    linear: ClassVar[bool] = True  # is f linear in θ? otherwise `torque` and `jacobian` are overridden
    dissipative: ClassVar[bool] = False  # friction: never adds power within its bounds
    of_torque: ClassVar[bool] = False  # Φ depends on the actuator torque, in proportion to it for either sign
    of_acceleration: ClassVar[bool] = False  # Φ depends on q̈, and is affine in it
    weighs: ClassVar[bool] = False  # Φ depends on gravity
    reads: ClassVar[bool] = False  # distorts the torque reading after all else, not the motion
    shifts: ClassVar[bool] = False  # distorts the position reading: the arm is at q + `shift`
    tilts: ClassVar[bool] = False  # turns gravity by `gravity_change`, for all bodies on the arm as well
    slight: ClassVar[bool] = False  # many small errors as one: it needs no large torque to be worth a name
    rarity: ClassVar[float] = 0.0  # how much sooner another explanation of equal merit is believed [1]

    def __post_init__(self) -> None:
        for p in self.shape:
            value = getattr(self, p.name)
            if not isinstance(value, Real) or not p.lower <= float(value) <= p.upper:
                raise EffectError(
                    f"{self.label}: {p.name} must lie within {p.lower:g} and {p.upper:g}, given {value!r}"
                )

    # ------------------------------------------------------------- physics

    @abstractmethod
    def basis(self, x: State) -> Array:
        """Return Φ, the torque per unit of each parameter near θ = 0, shape (N, n, p)."""

    def torque(self, x: State, theta: Array) -> Array:
        """Return f [N·m or N] for parameters θ (p,), shape (N, n)."""
        return self.basis(x) @ theta

    def jacobian(self, x: State, theta: Array) -> Array:
        """Return ∂f/∂θ, shape (N, n, p)."""
        return self.basis(x)

    def shift(self, robot: RobotModel, theta: Array) -> Array:
        """Return by how much the arm is further than its encoders read [rad or m], shape (n,)."""
        return np.zeros(robot.n)

    def gravity_change(self, robot: RobotModel, theta: Array) -> Array:
        """Return by how much gravity differs from the robot's [m/s²], shape (3,)."""
        return np.zeros(3)

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return the smallest and largest physical parameters for this robot, each shape (p,)."""
        return (
            np.array([p.lower for p in self.parameters]),
            np.array([p.upper for p in self.parameters]),
        )

    def is_physical(self, theta: Array, robot: RobotModel) -> bool:
        """Tell whether the parameters, taken together, can belong to a real arm."""
        lower, upper = self.bounds(robot)
        return bool(np.all(theta >= lower) and np.all(theta <= upper))

    def nearest_physical(self, theta: Array, robot: RobotModel) -> Array:
        """Return the physical parameters next to an estimate, shape (p,); a physical one is kept as it is."""
        return np.clip(theta, *self.bounds(robot))

    def prior_scale(self, robot: RobotModel) -> Array:
        """Return the size of parameter that would surprise nobody, ``inf`` where unknown, shape (p,).

        It keeps apart what a motion does not tell apart; where the motion does, it has no weight.
        """
        return np.full(self.size, INF)

    def is_distinct(self, theta: Array) -> bool:
        """Tell whether the parameters make it more than a simpler effect with another name."""
        return True

    @property
    def bodies(self) -> tuple[Body, ...]:
        """Rigid bodies whose parameters, one after another, are those of the effect; none for most."""
        return ()

    def by_body(self, theta: Array) -> Iterator[tuple[Body, Array]]:
        """Yield each rigid body with its own of the parameters θ (p,), shape (10,), a view of them."""
        if self.bodies:
            yield from zip(self.bodies, theta.reshape(len(self.bodies), -1), strict=True)

    # ------------------------------------------------------------- scope and names

    @property
    def scope(self) -> tuple[str, ...]:
        """Joints named by the effect; empty for an effect of the whole arm."""
        return tuple(getattr(self, f) for f in self.scope_fields if getattr(self, f) is not None)

    @property
    def label(self) -> str:
        """Name with its scope, such as ``coulomb_friction@elbow_joint`` or ``payload``."""
        return self.name + ("@" + "+".join(self.scope) if self.scope else "")

    def check(self, robot: RobotModel) -> None:
        """Make sure that the robot can have the effect.

        Raises:
            RobotError: If a joint is not of the robot.
            EffectError: If the joints cannot have such an effect.
        """
        for joint in self.scope:
            robot.joint_index(joint)

    def joints(self, robot: RobotModel) -> tuple[str, ...]:
        """Return the joints that the effect names; all of them for an effect of the whole arm."""
        return self.scope or robot.joints

    def acts_on(self, robot: RobotModel) -> tuple[int, ...]:
        """Return the indices of the joints whose torque the effect can change."""
        return tuple(range(robot.n))

    def units(self, robot: RobotModel) -> tuple[str, ...]:
        """Return the unit of each parameter on this robot."""
        prismatic = bool(self.scope) and bool(robot.is_prismatic[robot.joint_index(self.scope[0])])
        words = {
            "effort": "N" if prismatic else "N·m",
            "position": "m" if prismatic else "rad",
            "inertia": "kg" if prismatic else "kg·m²",
        }
        return tuple(p.unit.format(**words) for p in self.parameters)

    @property
    def size(self) -> int:
        """Number of parameters p."""
        return len(self.parameters)

    @property
    def shape_values(self) -> dict[str, float]:
        """Values of the shape parameters s."""
        return {p.name: getattr(self, p.name) for p in self.shape}

    # ------------------------------------------------------------- variants

    def with_shape(self, **shape: float) -> Self:
        """Return the effect with other shape parameters."""
        return replace(self, **shape)  # type: ignore[type-var]

    @classmethod
    def scopes(cls, robot: RobotModel) -> Iterator[tuple[str, ...]]:
        """Yield every scope in which the effect can be asked for on this robot."""
        yield ()

    def shape_grid(self, x: State) -> Sequence[Self]:
        """Return the effect at the shapes worth trying on this motion; itself where it has none."""
        return [self]

    # ------------------------------------------------------------- files

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-ready description; `cdia_pin.effects.effect_from_dict` reads it back."""
        out: dict[str, Any] = {"effect": self.name, "joints": list(self.scope)}
        shape = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in self.scope_fields}  # type: ignore[arg-type]
        if shape:
            out["shape"] = shape
        return out

    @classmethod
    def from_scope(cls, scope: Sequence[str], shape: Mapping[str, Any]) -> Self:
        """Build the effect from joint names and shape parameters.

        Raises:
            EffectError: If the number of joints or a shape parameter does not fit.
        """
        most = len(cls.scope_fields)
        least = most - sum(cls._default(f) is None for f in cls.scope_fields)
        if not least <= len(scope) <= most or not all(isinstance(j, str) and j for j in scope):
            count = f"{least}" if least == most else f"{least} or {most}"
            hint = cls.name + ("@" + "+".join(["JOINT"] * most) if most else "")
            given = "+".join(map(str, scope)) or "none"
            raise EffectError(f"{cls.name} takes {count} joint(s), given {given}: write {hint}")
        valid = {f.name for f in fields(cls)} - set(cls.scope_fields)  # type: ignore[arg-type]
        for key in shape:
            if key not in valid:
                raise EffectError(f"{cls.name}: " + unknown_name("shape parameter", key, sorted(valid)))
        return cls(**dict(zip(cls.scope_fields, scope, strict=False)), **shape)

    @classmethod
    def _default(cls, field_name: str) -> Any:
        return next(f.default for f in fields(cls) if f.name == field_name)  # type: ignore[arg-type]
