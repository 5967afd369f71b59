"""What surrounds the arm: its mounting, contact forces, a fluid."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.nonlinear_effect import NonlinearEffect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.plausibility import Plausibility
from cdia_pin.effects.state import State
from cdia_pin.effects.traits import Signal, Traits
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

STEEPEST = 0.9  # [1], largest part of gravity that a tilt moves sideways, 64°


@dataclass(frozen=True)
class BaseTilt(NonlinearEffect):
    """Gravity does not point where the URDF says, f = −K(q) Δg with |g + Δg| = |g|.

    ``tilt_x`` and ``tilt_y`` are the parts of gravity added across it: along the x and y axes of a base whose
    gravity is along z, else along the two base axes most across gravity, in their order. What they take from
    the main axis follows from gravity's constant size, so f is not linear. The effect's own `torque` is that of
    the robot; bodies that a model adds to it feel the tilt too.
    """

    name: ClassVar[str] = "base_tilt"
    plausibility: ClassVar[Plausibility] = Plausibility(unusual=True)
    equation: ClassVar[str] = "−K(q) Δg,  |g + Δg| = |g|"
    parameters = (Parameter("tilt_x", "m/s²"), Parameter("tilt_y", "m/s²"))
    traits: ClassVar[Traits] = Traits({Signal.POSITION}, linear=False, turns_gravity=True)

    def torque(self, x: State, theta: Array) -> Array:
        """Return f [N·m or N] for the tilt θ = (tilt_x, tilt_y) [m/s²], shape (N, n).

        Args:
            x: Motion and torques, N samples.
            theta: (tilt_x, tilt_y) [m/s²].
        """
        return -x.gravity_regressor @ self.tilt(x.robot, theta)

    def jacobian(self, x: State, theta: Array) -> Array:
        """Return ∂f/∂θ, shape (N, n, 2).

        Args:
            x: Motion and torques, N samples.
            theta: (tilt_x, tilt_y) [m/s²].
        """
        gravity = x.robot.gravity_vector
        size = float(np.linalg.norm(gravity))
        if size == 0.0:
            return np.zeros((len(x), x.robot.n, 2))
        # a step of a fit may go beyond the steepest tilt for a moment
        left = np.sqrt(max(size**2 - float(theta @ theta), (1.0 - STEEPEST**2) * size**2))
        turning = _axes_across(tuple((gravity / size).tolist())).T - np.outer(gravity, theta) / (size * left)
        return np.asarray(-x.gravity_regressor @ turning)

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return bounds within which gravity keeps its size [m/s²].

        Args:
            robot: The arm, n joints.
        """
        most = STEEPEST * float(np.linalg.norm(robot.gravity_vector))
        return np.full(2, -most), np.full(2, most)

    def is_physical(self, theta: Array, robot: RobotModel) -> bool:
        """Tell whether both parts together leave something of gravity along its main axis.

        Args:
            theta: (tilt_x, tilt_y) [m/s²].
            robot: The arm, n joints.
        """
        _, most = self.bounds(robot)
        return bool(np.hypot(*theta) <= most[0])

    def nearest_physical(self, theta: Array, robot: RobotModel) -> Array:
        """Return the tilt towards the same side, no steeper than possible, shape (2,).

        Args:
            theta: (tilt_x, tilt_y) [m/s²].
            robot: The arm, n joints.
        """
        if self.is_physical(theta, robot):
            return np.array(theta, float)
        _, most = self.bounds(robot)
        return np.asarray(theta * (most[0] * (1 - 1e-12) / np.hypot(*theta)))

    def gravity_change(self, x: State, theta: Array) -> Array:
        """Return Δg [m/s²] of the tilt, alike at all samples, shape (N, 3).

        Args:
            x: Motion and torques, N samples.
            theta: (tilt_x, tilt_y) [m/s²].
        """
        return np.tile(self.tilt(x.robot, theta), (len(x), 1))

    def tilt(self, robot: RobotModel, theta: Array) -> Array:
        """Return Δg [m/s²] of the tilt θ = (tilt_x, tilt_y) [m/s²], shape (3,).

        Args:
            robot: The arm, n joints.
            theta: (tilt_x, tilt_y) [m/s²].
        """
        gravity = robot.gravity_vector
        size = float(np.linalg.norm(gravity))
        if size == 0.0:
            return np.zeros(3)  # where there is no gravity, a tilt changes nothing
        left = np.sqrt(max(size**2 - float(theta @ theta), 0.0))
        return np.asarray(
            theta @ _axes_across(tuple((gravity / size).tolist())) + gravity * (left / size - 1.0)
        )


@lru_cache(maxsize=64)
def _axes_across(unit: tuple[float, ...]) -> Array:
    """Return two unit vectors across a unit vector: the base axes most across it, made so exactly, (2, 3)."""
    direction = np.array(unit)
    along = int(np.argmax(np.abs(direction)))
    first, second = (np.eye(3)[i] for i in range(3) if i != along)
    first = first - (first @ direction) * direction
    first /= np.linalg.norm(first)
    second = second - (second @ direction) * direction - (second @ first) * first
    return np.stack([first, second / np.linalg.norm(second)])


@dataclass(frozen=True)
class ToolWrench(Effect):
    """A constant force and torque on the tool in base axes: a cable, a contact, f = Jᵀ F."""

    name: ClassVar[str] = "tool_wrench"
    plausibility: ClassVar[Plausibility] = Plausibility(unusual=True)
    equation: ClassVar[str] = "Jᵀ F"
    traits: ClassVar[Traits] = Traits({Signal.POSITION})
    parameters = (
        *(Parameter(f"force_{axis}", "N") for axis in "xyz"),
        *(Parameter(f"torque_{axis}", "N·m") for axis in "xyz"),
    )

    def basis(self, x: State) -> Array:
        """Return Jᵀ, shape (N, n, 6).

        Args:
            x: Motion and torques, N samples.
        """
        return np.swapaxes(x.tool_jacobian, 1, 2)


@dataclass(frozen=True)
class ExternalWrench(Effect):
    """A force and torque on the far end of a link in base axes: a push, a collision, f = Jᵀ F.

    It changes with time and is gone when the contact is gone: a monitor estimates it from moment to moment.

    Attributes:
        joint: Name of the joint that moves the link.
    """

    joint: str

    name: ClassVar[str] = "external_wrench"
    plausibility: ClassVar[Plausibility] = Plausibility(unusual=True, searched=False)
    equation: ClassVar[str] = "Jᵀ F(t)"
    traits: ClassVar[Traits] = Traits({Signal.POSITION})
    scope_fields: ClassVar[tuple[str, ...]] = ("joint",)
    parameters = ToolWrench.parameters

    def basis(self, x: State) -> Array:
        """Return Jᵀ of the link's end, shape (N, n, 6).

        Args:
            x: Motion and torques, N samples.
        """
        jacobians = x.robot.link_end_jacobians(x.q)[:, x.robot.joint_index(self.joint)]
        return np.swapaxes(jacobians, 1, 2)

    def acts_on(self, robot: RobotModel) -> tuple[int, ...]:
        """Return the indices of the joints between the base and the link.

        Args:
            robot: The arm, n joints.
        """
        return tuple(range(robot.joint_index(self.joint) + 1))

    @classmethod
    def scopes(cls, robot: RobotModel) -> Iterator[tuple[str, ...]]:
        """Yield every joint that moves a link.

        Args:
            robot: The arm, n joints.
        """
        yield from ((j,) for j in robot.joints)


@dataclass(frozen=True)
class ViscousMedium(Effect):
    """A fluid around the arm: drag and buoyancy, f = −d Σ wₗ JₗᵀJₗ q̇ + (m_d/m) G ([Thesis] 2.1).

    Drag and displaced volume are shared among the links by their mass (wₗ = mₗ/m), since a URDF does not say
    how wide a link is. The fluid's added mass is left out.
    """

    name: ClassVar[str] = "viscous_medium"
    plausibility: ClassVar[Plausibility] = Plausibility(unusual=True)
    equation: ClassVar[str] = "−d Σ wₗ JₗᵀJₗ q̇ + (m_d/m) G"
    traits: ClassVar[Traits] = Traits({Signal.POSITION, Signal.VELOCITY, Signal.GRAVITY})
    parameters = (Parameter("drag", "N·s/m", lower=0.0), Parameter("displaced_mass", "kg", lower=0.0))

    def basis(self, x: State) -> Array:
        """Return the columns of drag and displaced mass, shape (N, n, 2).

        Args:
            x: Motion and torques, N samples.
        """
        drag = -np.einsum("kij,kj->ki", x.drag_matrix, x.v)
        buoyancy = np.einsum("kig,kg->ki", x.gravity_regressor, x.gravity) / x.robot.total_mass
        return np.stack([drag, buoyancy], axis=-1)
