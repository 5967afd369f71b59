"""A rigid body as an effect: its ten inertial parameters, linear in the torque."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.rigid_body import RigidBody
from cdia_pin.effects.state import State
from cdia_pin.effects.traits import Signal, Traits
from cdia_pin.robot.inertia import from_pseudo_inertia, is_physical, pseudo_inertia
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

BODY = (
    Parameter("mass", "kg"),
    *(Parameter(f"first_moment_{axis}", "kg·m") for axis in "xyz"),
    *(Parameter(f"inertia_{axes}", "kg·m²") for axes in ("xx", "xy", "yy", "xz", "yz", "zz")),
)
USUAL_MASS = 5.0  # [kg], least standard deviation of a body's mass: what small and middle-sized arms carry
USUAL_REACH = 0.3  # [m], standard deviation of the distance of its centre of mass: about a link's length
ROUNDING = 1e-5  # [1], smallest second moment of a possible body, relative to their sum


class Body(RigidBody, Effect):
    """The effect of a rigid body that is added to, or taken from, the link of a joint."""

    parameters = BODY
    traits: ClassVar[Traits] = Traits({Signal.POSITION, Signal.VELOCITY, Signal.ACCELERATION, Signal.GRAVITY})

    @property
    def bodies(self) -> tuple[RigidBody, ...]:
        """The body itself."""
        return (self,)

    def basis(self, x: State) -> Array:
        """Return −Y of a unit body, shape (N, n, 10).

        Args:
            x: Motion and torques, N samples.
        """
        found = self._regressor(x)
        return (found.reshape(-1, 10) @ -self.to_joint_frame(x.robot)).reshape(
            found.shape
        )  # one product, not N

    def torque(self, x: State, theta: Array) -> Array:
        """Return f = −Y π [N·m or N] for the body θ = π, shape (N, n).

        Args:
            x: Motion and torques, N samples.
            theta: π in the body's frame [kg, kg·m, kg·m²], shape (10,).
        """
        return -x.body_torque(self.carrier(x.robot), self.in_joint_frame(theta, x.robot))

    def is_physical(self, theta: Array, robot: RobotModel) -> bool:
        """Tell whether link and body together are a possible body.

        Args:
            theta: π in the body's frame [kg, kg·m, kg·m²], shape (10,).
            robot: The arm, n joints.
        """
        return super().is_physical(theta, robot) and bool(is_physical(self.total(theta, robot), ROUNDING))

    def nearest_physical(self, theta: Array, robot: RobotModel) -> Array:
        """Return an estimate with mass and first moments kept and its inertia made possible, shape (10,).

        The mass is raised where it must be; second moments about the centre of mass lose what is negative.

        Args:
            theta: π in the body's frame [kg, kg·m, kg·m²], shape (10,).
            robot: The arm, n joints.
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
        """Return standard deviations of a body as heavy as its link, near its joint, shape (10,).

        Args:
            robot: The arm, n joints.
        """
        mass = max(USUAL_MASS, float(robot.inertial_parameters[self.carrier(robot)][0]))
        return np.array([mass] + [mass * USUAL_REACH] * 3 + [mass * USUAL_REACH**2] * 6)

    def _regressor(self, x: State) -> Array:
        return x.body_regressor(self.carrier(x.robot))
