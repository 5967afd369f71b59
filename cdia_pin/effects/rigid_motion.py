"""What the rigid bodies of an arm need along a motion, computed once for all states that share it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# Motions at other positions [1] that are kept: a fit with two encoder zeros needs five, one where the arm is and two
# for each derivative.
MOST_SHIFTED = 8
MOST_SAMPLES = (
    60_000  # samples of such motions [1] that are kept in all, about 10 kB each; one motion in any case
)
ROWS = 2048  # samples [1] whose regressors of all links are formed at once: 16 MB


@dataclass(frozen=True, eq=False, repr=False)
class RigidMotion:
    """Torques and regressors of the rigid bodies along a motion, which depend on nothing else.

    Attributes:
        robot: The rigid-body model.
        q: Joint positions [rad or m], shape (N, n).
        v: Joint velocities [rad/s or m/s], shape (N, n).
        a: Joint accelerations [rad/s² or m/s²], shape (N, n).
    """

    robot: RobotModel
    q: Array
    v: Array
    a: Array

    def __repr__(self) -> str:
        return f"RigidMotion({self.robot.name}, {len(self.q)} samples)"

    def at(self, q: Array) -> RigidMotion:
        """Return the motion with the same speeds at other positions; the last few are kept.

        Args:
            q: Positions [rad or m], shape (N, n).
        """
        key = q.tobytes()
        found = self._shifted.pop(key, None) or replace(self, q=q)
        self._shifted[key] = found
        while len(self._shifted) > min(MOST_SHIFTED, max(MOST_SAMPLES // len(q), 1)):
            self._shifted.pop(next(iter(self._shifted)))
        return found

    @cached_property
    def torque(self) -> Array:
        """M q̈ + nle of the robot as described [N·m or N], shape (N, n)."""
        return self.robot.inverse_dynamics(self.q, self.v, self.a)

    @cached_property
    def body_regressors(self) -> list[Array]:
        """Y with M q̈ + nle = Y π for a body on each link, under the robot's gravity, shapes (N, n, 10)."""
        out = [np.empty((len(self.q), self.robot.n, 10)) for _ in range(self.robot.n)]
        for at in self._blocks():
            whole = self.robot.torque_regressor(self.q[at], self.v[at], self.a[at])
            for j, own in enumerate(out):
                own[at] = whole[:, :, 10 * j : 10 * (j + 1)]
        return out

    @cached_property
    def body_weights(self) -> list[Array]:
        """∂Y/∂g of each link's mass and first moments, which alone have a weight, shapes (4, N, n, 3)."""
        out = [np.empty((4, len(self.q), self.robot.n, 3)) for _ in range(self.robot.n)]
        for at in self._blocks():
            by_gravity = np.moveaxis(self.robot.weight_regressor(self.q[at]), 2, 0)
            for j, own in enumerate(out):
                own[:, at] = by_gravity[10 * j : 10 * j + 4]
        return out

    def _blocks(self) -> Iterator[slice]:
        return (slice(start, start + ROWS) for start in range(0, len(self.q), ROWS))

    @cached_property
    def gravity_regressor(self) -> Array:
        """K with G = K g, shape (N, n, 3)."""
        return self.robot.gravity_regressor(self.q)

    @cached_property
    def tool_jacobian(self) -> Array:
        """Jacobian of the tool in base axes, shape (N, 6, n)."""
        return self.robot.tool_jacobian(self.q)

    @cached_property
    def drag_matrix(self) -> Array:
        """Mass-weighted mean of JₗᵀJₗ at the links' centres of mass, shape (N, n, n)."""
        return self.robot.point_mass_matrix(self.q) / self.robot.total_mass

    @cached_property
    def _shifted(self) -> dict[bytes, RigidMotion]:
        return {}
