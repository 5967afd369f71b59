"""What surrounds the arm: its mounting, contact forces, a fluid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect, NonlinearEffect, Parameter
from cdia_pin.effects.state import State

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BaseTilt(NonlinearEffect):
    """Gravity does not point where the URDF says, f = −K(q) Δg with |g + Δg| = |g|.

    ``tilt_x`` and ``tilt_y`` are the parts of gravity added along the two base axes across it; what they take
    from the main axis follows from its constant size, so f is not linear.
    """

    name: ClassVar[str] = "base_tilt"
    equation: ClassVar[str] = "−K(q) Δg,  |g + Δg| = |g|"
    parameters = (
        Parameter("tilt_x", "m/s²", lower=-9.0, upper=9.0),
        Parameter("tilt_y", "m/s²", lower=-9.0, upper=9.0),
    )
    steps: ClassVar[tuple[float, ...]] = (1e-5, 1e-5)

    def torque(self, x: State, theta: Array) -> Array:
        """Return f [N·m or N] for the tilt θ = (tilt_x, tilt_y) [m/s²], shape (N, n)."""
        return -x.gravity_regressor @ self.gravity_change(x.robot.gravity_vector, theta)

    @staticmethod
    def gravity_change(gravity: Array, theta: Array) -> Array:
        """Return Δg [m/s²] of the tilt, shape (3,)."""
        size = float(np.linalg.norm(gravity))
        sideways = float(theta @ theta)
        left = np.sqrt(max(size**2 - sideways, 0.0))
        return np.array([*theta, 0.0]) + gravity * (left / size - 1.0)


@dataclass(frozen=True)
class ToolWrench(Effect):
    """A constant force and torque on the tool in base axes: a cable, a contact, f = Jᵀ F."""

    name: ClassVar[str] = "tool_wrench"
    equation: ClassVar[str] = "Jᵀ F"
    parameters = (
        *(Parameter(f"force_{axis}", "N") for axis in "xyz"),
        *(Parameter(f"torque_{axis}", "N·m") for axis in "xyz"),
    )

    def basis(self, x: State) -> Array:
        """Return Jᵀ, shape (N, n, 6)."""
        return np.swapaxes(x.tool_jacobian, 1, 2)


@dataclass(frozen=True)
class ViscousMedium(Effect):
    """A fluid around the arm: drag on the links and buoyancy, f = −d Σ wₗ JₗᵀJₗ q̇ + (m_d/m) G (thesis 2.1).

    Drag and displaced volume are shared among the links by their mass (wₗ = mₗ/m), since a URDF does not say
    how wide a link is.
    """

    name: ClassVar[str] = "viscous_medium"
    equation: ClassVar[str] = "−d Σ wₗ JₗᵀJₗ q̇ + (m_d/m) G"
    parameters = (Parameter("drag", "N·s/m", lower=0.0), Parameter("displaced_mass", "kg", lower=0.0))

    def basis(self, x: State) -> Array:
        """Return the columns of drag and displaced mass, shape (N, n, 2)."""
        drag = -np.einsum("kij,kj->ki", x.drag_matrix, x.v)
        buoyancy = x.gravity_regressor @ x.robot.gravity_vector / x.robot.total_mass
        return np.stack([drag, buoyancy], axis=-1)
