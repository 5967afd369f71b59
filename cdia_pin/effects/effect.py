r"""The contract of an effect: physics of unknown size, written once and used in four roles.

An effect adds torque on the right of :math:`M \ddot q + \mathrm{nle} = \tau + f` with

.. math:: f = \Phi(x; s)\,\theta

It is a fault in a simulated plant, a hypothesis of an isolation bank, a candidate for what a model lacks
in a log, and a part of an improved model, without knowing which.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from numbers import Real
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.memory import Memory
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.plausibility import Plausibility
from cdia_pin.effects.rigid_body import RigidBody
from cdia_pin.effects.scoped import Scoped
from cdia_pin.effects.state import State
from cdia_pin.effects.traits import Traits
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
INF = float("inf")


class Effect(Scoped, ABC):
    """Base of all effects: a subclass states its parameters, its traits and its basis Φ, nothing else.

    Subclasses are frozen dataclasses; their fields are the scope (a joint, two joints, or nothing for the
    whole arm) and the shape parameters s. The contract tests check what a subclass states.
    """

    name: ClassVar[str]
    equation: ClassVar[str]
    parameters: tuple[Parameter, ...]
    plausibility: ClassVar[Plausibility] = Plausibility()

    def __post_init__(self) -> None:
        for p in self.shape:
            value = getattr(self, p.name)
            if not isinstance(value, Real) or not p.lower <= float(value) <= p.upper:
                raise EffectError(
                    f"{self.label}: {p.name} must lie within {p.lower:g} and {p.upper:g}, given {value!r}"
                )

    # ------------------------------------------------------------- physics

    @property
    @abstractmethod
    def traits(self) -> Traits:
        """What is true of the effect's physics; a class variable in most subclasses."""

    @abstractmethod
    def basis(self, x: State) -> Array:
        """Return Φ, the torque per unit of each parameter near θ = 0, shape (N, n, p).

        Args:
            x: Motion and torques, N samples.
        """

    def torque(self, x: State, theta: Array) -> Array:
        """Return f [N·m or N] for parameters θ (p,), shape (N, n).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        phi = self.basis(x)
        return (phi.reshape(-1, phi.shape[-1]) @ theta).reshape(phi.shape[:-1])  # one product, not N

    def torques(self, x: State, efforts: Array, theta: Array) -> Array:
        """Return f under several actuator torques [N·m or N], shape (N, n, k).

        Args:
            x: The motion, N samples; its ``effort`` is not used.
            efforts: The actuator torques [N·m or N], shape (N, n, k).
            theta: Parameters θ, shape (p,).
        """
        each = [self.torque(x.with_effort(effort), theta) for effort in np.moveaxis(efforts, 2, 0)]
        return np.stack(each, axis=2)

    def jacobian(self, x: State, theta: Array) -> Array:
        """Return ∂f/∂θ for parameters θ (p,), shape (N, n, p).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        return self.basis(x)

    def shift(self, x: State, theta: Array) -> Array:
        """Return by how much the arm is further than its encoders read [rad or m], shape (N, n).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        return np.zeros_like(x.q)

    def gravity_change(self, x: State, theta: Array) -> Array:
        """Return by how much gravity differs from the robot's [m/s²], shape (N, 3).

        Args:
            x: Motion and torques, N samples.
            theta: Parameters θ, shape (p,).
        """
        return np.zeros((len(x), 3))

    @property
    def memories(self) -> tuple[Memory, ...]:
        """Internal states by which the torque depends on the past; none for most."""
        return ()

    @property
    def steady(self) -> Effect | None:
        """The effect of the same parameters that it is where the past has no weight; None if there is none."""
        return None if self.memories else self

    @property
    def bodies(self) -> tuple[RigidBody, ...]:
        """Rigid bodies whose parameters, one after another, are those of the effect; none for most."""
        return ()

    def by_body(self, theta: Array) -> Iterator[tuple[RigidBody, Array]]:
        """Yield each rigid body with its own of the parameters θ (p,), shape (10,), a view of them.

        Args:
            theta: Parameters θ, shape (p,).
        """
        if self.bodies:
            yield from zip(self.bodies, theta.reshape(len(self.bodies), -1), strict=True)

    def on_links(self, theta: Array, robot: RobotModel) -> Array:
        """Return what the bodies of the effect add to the inertial parameters of the links, shape (n, 10).

        Args:
            theta: Parameters θ, shape (p,).
            robot: The arm, n joints.
        """
        out = np.zeros((robot.n, 10))
        for body, part in self.by_body(theta):
            out[body.carrier(robot)] += body.in_joint_frame(part, robot)
        return out

    # ------------------------------------------------------------- parameters

    @property
    def size(self) -> int:
        """Number of parameters p."""
        return len(self.parameters)

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return the smallest and largest physical parameters for this robot, each shape (p,).

        Args:
            robot: The arm, n joints.
        """
        return (
            np.array([p.lower for p in self.parameters]),
            np.array([p.upper for p in self.parameters]),
        )

    def is_physical(self, theta: Array, robot: RobotModel) -> bool:
        """Tell whether the parameters θ (p,), taken together, can belong to a real arm.

        Args:
            theta: Parameters θ, shape (p,).
            robot: The arm, n joints.
        """
        lower, upper = self.bounds(robot)
        return bool(np.all(theta >= lower) and np.all(theta <= upper))

    def nearest_physical(self, theta: Array, robot: RobotModel) -> Array:
        """Return the physical parameters next to an estimate θ, shape (p,); a physical one is kept as it is.

        Args:
            theta: Parameters θ, shape (p,).
            robot: The arm, n joints.
        """
        return np.clip(theta, *self.bounds(robot))

    def prior_scale(self, robot: RobotModel) -> Array:
        """Return the prior standard deviation of each parameter, ``inf`` where nothing is known, shape (p,).

        It decides between parameters that a motion cannot tell apart; where the motion can, it has no weight.

        Args:
            robot: The arm, n joints.
        """
        return np.full(self.size, INF)

    def is_distinct(self, theta: Array) -> bool:
        """Tell whether the parameters θ (p,) make it more than a simpler effect with another name.

        Args:
            theta: Parameters θ, shape (p,).
        """
        return True

    @property
    def simpler(self) -> Effect | None:
        """The effect that it is where its parameters do not make it distinct; None if there is no such effect."""
        return None

    # ------------------------------------------------------------- on a robot and a motion

    def acts_on(self, robot: RobotModel) -> tuple[int, ...]:
        """Return the indices of the joints whose torque the effect can change.

        Args:
            robot: The arm, n joints.
        """
        return tuple(range(robot.n))

    def units(self, robot: RobotModel) -> tuple[str, ...]:
        """Return the unit of each parameter on this robot.

        Args:
            robot: The arm, n joints.
        """
        prismatic = bool(self.scope) and bool(robot.is_prismatic[robot.joint_index(self.scope[0])])
        return tuple(p.unit_on(prismatic) for p in self.parameters)

    def shape_grid(self, x: State) -> Sequence[Self]:
        """Return the effect at the shapes worth trying on this motion; itself where it has none.

        Args:
            x: Motion and torques, N samples.
        """
        return [self]

    def nearly_alike(self, x: State) -> Sequence[Self]:
        """Return the effect at the nearest shapes that this motion tells from its own; none where it has no shape.

        Args:
            x: Motion and torques, N samples.
        """
        return []


def share_a_joint(one: Effect, other: Effect, robot: RobotModel) -> bool:
    """Tell whether two effects can change the torque of the same joint.

    Args:
        one: One effect.
        other: The other.
        robot: The arm, n joints.
    """
    return not set(one.acts_on(robot)).isdisjoint(other.acts_on(robot))
