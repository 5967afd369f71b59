"""What a motor's encoder does not see: the joint bends under its load."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.plausibility import Plausibility
from cdia_pin.effects.state import State
from cdia_pin.effects.traits import Signal, Traits
from cdia_pin.effects.weight import largest_weight, weighted_joints
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

USUAL_BEND = 0.005  # [rad], of a joint under the arm's own weight; gears of industrial arms bend by less
LARGEST_BEND = 0.1  # [rad], of a joint under the arm's own weight; the effect is of first order in it


@dataclass(frozen=True)
class JointElasticity(Effect):
    r"""The gear bends under its load, and the encoder is on the motor: f = c τ ∂G/∂q, c = 1 / k [DeLuca2016].

    The link is behind the motor by c τ. So gravity acts at another posture than the encoder says. τ is the torque of
    the robot as it is described, f is of first order in c, and all joints feel it. What is above the bandwidth of the
    filter, the oscillation of the link on its gear, is not in it: an encoder on the motor shows the two together only
    as a resonance. An encoder on the link sees nothing of it, so nothing of it is found there.

    Attributes:
        joint: Name of the joint.
    """

    joint: str

    name: ClassVar[str] = "joint_elasticity"
    equation: ClassVar[str] = "c τ ∂G/∂q"
    traits: ClassVar[Traits] = Traits({Signal.POSITION, Signal.VELOCITY, Signal.ACCELERATION})
    # it is small beside an encoder's zero
    plausibility: ClassVar[Plausibility] = Plausibility(penalty=6.0, unusual=True)
    scope_fields: ClassVar[tuple[str, ...]] = ("joint",)
    parameters = (Parameter("compliance", "{position}/({effort})", lower=0.0),)

    def basis(self, x: State) -> Array:
        """Return Φ, shape (N, n, 1).

        Args:
            x: Motion and torques, N samples.
        """
        j = x.robot.joint_index(self.joint)
        return np.asarray(x.gravity_stiffness[:, :, [j]] * x.rigid_torque[:, j, None, None])

    def bounds(self, robot: RobotModel) -> tuple[Array, Array]:
        """Return bounds within which the joint bends by little under the arm's own weight.

        Args:
            robot: The arm, n joints.
        """
        return np.zeros(1), LARGEST_BEND * self._per_bend(robot)

    def prior_scale(self, robot: RobotModel) -> Array:
        """Return the compliance of a joint that bends by 5 mrad under the arm's own weight, shape (1,).

        Args:
            robot: The arm, n joints.
        """
        return USUAL_BEND * self._per_bend(robot)

    @classmethod
    def scopes(cls, robot: RobotModel) -> Iterator[tuple[str, ...]]:
        """Yield every revolute joint that gravity loads.

        Args:
            robot: The arm, n joints.
        """
        yield from ((j,) for j in weighted_joints(robot))

    def _per_bend(self, robot: RobotModel) -> Array:
        """Return the compliance for each radian of bend under the arm's own weight [1/(N·m)], shape (1,)."""
        weight = largest_weight(robot)
        own = float(weight[robot.joint_index(self.joint)])
        return np.array([1.0 / (own or float(weight.max()) or 1.0)])
