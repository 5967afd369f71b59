"""A spring on a lever arm that carries a part of the arm's weight: a coil that pulls, or gas that pushes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.joint_effect import JointEffect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.plausibility import Plausibility
from cdia_pin.effects.state import JointState, State
from cdia_pin.effects.traits import Signal, Traits
from cdia_pin.effects.weight import largest_weight, weighted_joints
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

CENTRES = 24  # angles [1] on the full circle; a parabola refines them
RATIOS = (-0.7, -0.35, 0.35, 0.7)  # lever over the distance of the anchor [1]; pushing below zero
CARRIES = 0.5  # correlation of its torque with the weight on the joint [1] from which it is a counterbalance
LOOKED_AT = 200  # samples [1] at which it is compared with the weight


@dataclass(frozen=True)
class Counterbalance(JointEffect):
    r"""A spring on a lever arm, f = −F(λ) sin φ / λ with φ = q − q₀ and λ = √(1 + r² − 2 r cos φ).

    One end of the spring is anchored in the link before the joint, the other one at the lever on the link after it.
    λ is its length over the distance of the anchor from the axis. The force F changes in proportion to the length; it
    is given by its torque at the lever with the joint at q₀ and opposite to it. Both are positive: the spring drives
    the joint to q₀. A coil spring that pulls has r > 0, and it is the shortest at q₀. A gas spring that pushes from the
    other side has r < 0, it is the longest at q₀, and its force hardly changes.

    Attributes:
        centre: q₀, where the spring drives the joint [rad].
        ratio: r, lever over the distance of the anchor [1]; negative where the spring pushes.
    """

    centre: float = 0.0
    ratio: float = 0.5

    name: ClassVar[str] = "counterbalance"
    equation: ClassVar[str] = "−F(λ) sin(q − q₀) / λ,  λ² = 1 + r² − 2 r cos(q − q₀)"
    traits: ClassVar[Traits] = Traits({Signal.POSITION})
    # few arms have one, and then it is known
    plausibility: ClassVar[Plausibility] = Plausibility(penalty=6.0, unusual=True)
    parameters = (
        Parameter("torque_at_centre", "{effort}", lower=0.0),
        Parameter("torque_opposite", "{effort}", lower=0.0),
    )
    shape = (
        Parameter("centre", "{position}"),  # near the motion, which may be many turns from zero
        Parameter("ratio", "1", lower=-0.95, upper=0.95),
    )

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the columns of the force at the centre and of that opposite to it.

        Args:
            x: Signals of the joint, N samples.
        """
        angle = x.q - self.centre
        length = np.sqrt(1 + self.ratio**2 - 2 * self.ratio * np.cos(angle))
        lever = -np.sin(angle) / length
        opposite = (1 - np.cos(angle)) / (length + 1 - self.ratio)  # 0 at the centre, 1 opposite to it
        return ((1 - opposite) * lever, opposite * lever)

    def prior_scale(self, robot: RobotModel) -> Array:
        """Return the largest weight that the joint carries, because more would lift the arm, shape (2,).

        Args:
            robot: The arm, n joints.
        """
        weight = float(largest_weight(robot)[robot.joint_index(self.joint)])
        return np.full(2, weight if weight > 0 else np.inf)

    def check(self, robot: RobotModel) -> None:
        """Make sure that the joint turns: a lever has no angle on a joint that slides.

        Args:
            robot: The arm, n joints.
        """
        super().check(robot)
        if robot.is_prismatic[robot.joint_index(self.joint)]:
            raise EffectError(f"{self.label}: a lever needs a joint that turns")

    @classmethod
    def scopes(cls, robot: RobotModel) -> Iterator[tuple[str, ...]]:
        """Yield every revolute joint that gravity loads.

        Args:
            robot: The arm, n joints.
        """
        yield from ((j,) for j in weighted_joints(robot))

    def shape_grid(self, x: State) -> Sequence[Self]:
        """Return centres and ratios with which it carries weight on this motion, not springs of another purpose.

        Args:
            x: Motion and torques, N samples.
        """
        j = x.robot.joint_index(self.joint)
        q = x.q[:: max(1, len(x) // LOOKED_AT)]
        weight = x.robot.gravity(q)[:, j]
        # an angle enters the fit as a number, so centres are those nearest to the motion
        around = np.median(q[:, j]) + np.pi * np.linspace(-1, 1, CENTRES, endpoint=False)
        pull = -np.sin(q[:, [j]] - around)
        alike = (pull.T @ weight) / np.maximum(np.linalg.norm(pull, axis=0) * np.linalg.norm(weight), 1e-9)
        carrying = around[alike > CARRIES]
        return [self.with_shape(centre=float(c), ratio=r) for c, r in product(carrying, RATIOS)]
