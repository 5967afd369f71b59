"""Effects made of another effect: the whole contract is that of the inner one, a subclass changes what differs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.memory import Memory
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.plausibility import Plausibility
from cdia_pin.effects.records import EffectRecord
from cdia_pin.effects.rigid_body import RigidBody
from cdia_pin.effects.state import State
from cdia_pin.effects.traits import Traits
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


class WrappedEffect(Effect):
    """An effect made of another one, whose contract it has in all that a subclass does not override.

    Subclasses are frozen dataclasses whose first field is the inner effect.
    """

    effect: Effect

    def __post_init__(self) -> None:
        """The inner effect has checked its shape itself."""

    # ------------------------------------------------------------- what it is

    @property
    def name(self) -> str:  # type: ignore[override]
        """Name of the inner effect."""
        return self.effect.name

    @property
    def equation(self) -> str:  # type: ignore[override]
        """Equation of the inner effect."""
        return self.effect.equation

    @property
    def traits(self) -> Traits:
        """Traits of the inner effect."""
        return self.effect.traits

    @property
    def plausibility(self) -> Plausibility:  # type: ignore[override]
        """Plausibility of the inner effect."""
        return self.effect.plausibility

    @property
    def parameters(self) -> tuple[Parameter, ...]:  # type: ignore[override]
        """Parameters of the inner effect."""
        return self.effect.parameters

    @property
    def shape(self) -> tuple[Parameter, ...]:  # type: ignore[override]
        """Shape parameters of the inner effect."""
        return self.effect.shape

    @property
    def memories(self) -> tuple[Memory, ...]:
        """Internal states of the inner effect."""
        return self.effect.memories

    @property
    def steady(self) -> Effect | None:
        """What the inner effect is where the past has no weight, in the same wrapper."""
        inner = self.effect.steady
        return None if inner is None else replace(self, effect=inner)  # type: ignore[type-var]

    @property
    def bodies(self) -> tuple[RigidBody, ...]:
        """Rigid bodies of the inner effect."""
        return self.effect.bodies

    # ------------------------------------------------------------- physics

    def basis(self, x: State) -> Array:
        """Return Φ, shape (N, n, p).

        Args:
            x: Motion and torques, N samples.
        """
        return self.effect.basis(x)

    def torque(self, x: State, theta: Array) -> Array:
        """Return f [N·m or N] for parameters θ (p,), shape (N, n).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        return self.effect.torque(x, theta)

    def jacobian(self, x: State, theta: Array) -> Array:
        """Return ∂f/∂θ for parameters θ (p,), shape (N, n, p).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        return self.effect.jacobian(x, theta)

    def shift(self, x: State, theta: Array) -> Array:
        """Return by how much the arm is further than its encoders read [rad or m], shape (N, n).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        return self.effect.shift(x, theta)

    def gravity_change(self, x: State, theta: Array) -> Array:
        """Return by how much gravity differs from the robot's [m/s²], shape (N, 3).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        return self.effect.gravity_change(x, theta)

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return the smallest and largest physical parameters, each shape (p,).

        Args:
            robot: The arm, n joints.
        """
        return self.effect.bounds(robot)

    def is_physical(self, theta: Array, robot: RobotModel) -> bool:
        """Tell whether the parameters, taken together, can belong to a real arm.

        Args:
            theta: Parameters θ, shape (p,).
            robot: The arm, n joints.
        """
        return self.effect.is_physical(theta, robot)

    def nearest_physical(self, theta: Array, robot: RobotModel) -> Array:
        """Return the physical parameters next to an estimate, shape (p,).

        Args:
            theta: Parameters θ, shape (p,).
            robot: The arm, n joints.
        """
        return self.effect.nearest_physical(theta, robot)

    def prior_scale(self, robot: RobotModel) -> Array:
        """Return the prior standard deviation of each parameter, shape (p,).

        Args:
            robot: The arm, n joints.
        """
        return self.effect.prior_scale(robot)

    def is_distinct(self, theta: Array) -> bool:
        """Tell whether the parameters make it more than a simpler effect with another name.

        Args:
            theta: Parameters θ, shape (p,).
        """
        return self.effect.is_distinct(theta)

    @property
    def simpler(self) -> Effect | None:
        """None: parameters that vary may reduce to those of a simpler effect in some of the logs alone."""
        return None

    # ------------------------------------------------------------- scope and names

    @property
    def scope_fields(self) -> tuple[str, ...]:  # type: ignore[override]
        """Fields of the inner effect that name joints."""
        return self.effect.scope_fields

    @property
    def scope(self) -> tuple[str, ...]:
        """Joints that the inner effect names."""
        return self.effect.scope

    @property
    def label(self) -> str:
        """Label of the inner effect."""
        return self.effect.label

    def check(self, robot: RobotModel) -> None:
        """Make sure that the robot can have the inner effect.

        Args:
            robot: The arm, n joints.
        """
        self.effect.check(robot)

    def joints(self, robot: RobotModel) -> tuple[str, ...]:
        """Return the joints that the inner effect names; all of them for an effect of the whole arm.

        Args:
            robot: The arm, n joints.
        """
        return self.effect.joints(robot)

    def acts_on(self, robot: RobotModel) -> tuple[int, ...]:
        """Return the indices of the joints whose torque the inner effect can change.

        Args:
            robot: The arm, n joints.
        """
        return self.effect.acts_on(robot)

    def units(self, robot: RobotModel) -> tuple[str, ...]:
        """Return the unit of each parameter on this robot.

        Args:
            robot: The arm, n joints.
        """
        return self.effect.units(robot)

    @property
    def shape_values(self) -> dict[str, float]:
        """Values of the inner effect's shape parameters."""
        return self.effect.shape_values

    def with_shape(self, **shape: float) -> Self:
        """Return the effect with other shape parameters of the inner effect.

        Args:
            shape: New values by name, each in the unit that `shape` states.
        """
        return replace(self, effect=self.effect.with_shape(**shape))  # type: ignore[type-var]

    def shape_grid(self, x: State) -> Sequence[Self]:
        """Return the effect at the shapes of the inner effect that are worth trying on this motion.

        Args:
            x: Motion and torques, N samples.
        """
        return [replace(self, effect=e) for e in self.effect.shape_grid(x)]  # type: ignore[type-var]

    def nearly_alike(self, x: State) -> Sequence[Self]:
        """Return the effect at the nearest shapes of the inner effect that this motion tells from its own.

        Args:
            x: Motion and torques, N samples.
        """
        return [replace(self, effect=e) for e in self.effect.nearly_alike(x)]  # type: ignore[type-var]

    def to_dict(self) -> EffectRecord:
        """Refuse to write what no file can hold; a subclass with a form in files overrides it.

        Raises:
            EffectError: Always.
        """
        raise EffectError(f"{self.label}: this effect has no form in a file")
