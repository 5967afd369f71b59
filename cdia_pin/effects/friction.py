"""Friction in the joints: torque against the motion, never adding power [Armstrong1994]."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.joint_effect import JointEffect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.smooth_sign import smooth_sign
from cdia_pin.effects.state import JointState, State
from cdia_pin.effects.traits import SensedFrom, Signal, Traits
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

VISCOUS = "{effort}·s/{position}"
LARGEST_DECAY = 1e4  # [s/rad or s/m], a Stribeck speed below any that an encoder shows


# Least breakaway over the level [1]; what filters do to Coulomb friction looks like a smaller one.
LEAST_BREAKAWAY = 0.2


def stribeck_decays(x: State, joint: str, count: int) -> list[float]:
    """Return decays β [s/rad or s/m] of friction that falls with speed, which a motion can show.

    The Stribeck speed 1 / β is wide beside the smoothing of sgn, which could imitate it, and narrow beside the speeds
    driven. There are none if the joint is never fast enough.

    Args:
        x: Motion and torques, N samples.
        joint: Name of the joint.
        count: Number of decays [1].
    """
    j = x.robot.joint_index(joint)
    fast = np.percentile(np.abs(x.v[:, j]), 95)
    width = float(np.broadcast_to(x.sign_width, (x.robot.n,))[j])
    narrowest = max(8.0 * width, 0.04 * fast, 1.0 / LARGEST_DECAY)
    if fast <= 3 * narrowest:
        return []
    return [float(1.0 / s) for s in np.geomspace(narrowest, fast / 3, count)]


@dataclass(frozen=True)
class CoulombFriction(JointEffect):
    """Dry friction of constant size, f = −α sgn q̇ ([Thesis] Table 2, Coulomb)."""

    name: ClassVar[str] = "coulomb_friction"
    equation: ClassVar[str] = "−α sgn(q̇)"
    traits: ClassVar[Traits] = Traits({Signal.DIRECTION}, dissipative=True, sensed=SensedFrom.MOTOR)
    parameters = (Parameter("level", "{effort}", lower=0.0),)

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the column of the level.

        Args:
            x: Signals of the joint, N samples.
        """
        return (-x.sign,)


@dataclass(frozen=True)
class ViscousFriction(JointEffect):
    """Friction in proportion to speed, f = −α q̇ ([Thesis] Table 2, Viscous)."""

    name: ClassVar[str] = "viscous_friction"
    equation: ClassVar[str] = "−α q̇"
    traits: ClassVar[Traits] = Traits({Signal.VELOCITY}, dissipative=True, sensed=SensedFrom.MOTOR)
    parameters = (Parameter("coefficient", VISCOUS, lower=0.0),)

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the column of the coefficient.

        Args:
            x: Signals of the joint, N samples.
        """
        return (-x.v,)


@dataclass(frozen=True)
class BearingFriction(JointEffect):
    """Friction of what carries a link, f = −(α sgn q̇ + β q̇), as a torque sensor behind the gear sees it.

    Bearings, seals and cables rub between that sensor and the link. A torque of the motor shows their friction as a
    part of its own Coulomb and viscous friction.
    """

    name: ClassVar[str] = "bearing_friction"
    equation: ClassVar[str] = "−(α sgn(q̇) + β q̇)"
    traits: ClassVar[Traits] = Traits(
        {Signal.VELOCITY, Signal.DIRECTION}, dissipative=True, sensed=SensedFrom.BEHIND
    )
    parameters = (
        Parameter("level", "{effort}", lower=0.0),
        Parameter("coefficient", VISCOUS, lower=0.0),
    )

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the columns of the level and of the coefficient.

        Args:
            x: Signals of the joint, N samples.
        """
        return (-x.sign, -x.v)


@dataclass(frozen=True)
class StribeckFriction(JointEffect):
    """Dry friction that falls as speed grows, f = −(α₀ + α₁ exp(−β|q̇|)) sgn q̇ ([Thesis] Table 2).

    Attributes:
        decay: β, inverse of the Stribeck speed [s/rad or s/m].
    """

    decay: float = 10.0

    name: ClassVar[str] = "stribeck_friction"
    equation: ClassVar[str] = "−(α₀ + α₁ exp(−β|q̇|)) sgn(q̇)"
    traits: ClassVar[Traits] = Traits(
        {Signal.VELOCITY, Signal.DIRECTION}, dissipative=True, sensed=SensedFrom.MOTOR
    )
    parameters = (
        Parameter("level", "{effort}", lower=0.0),
        Parameter("breakaway", "{effort}", lower=0.0),
    )
    shape = (Parameter("decay", "s/{position}", lower=1e-3, upper=LARGEST_DECAY),)

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the columns of the level and of the breakaway part.

        Args:
            x: Signals of the joint, N samples.
        """
        return (-x.sign, -np.exp(-self.decay * np.abs(x.v)) * x.sign)

    def is_distinct(self, theta: Array) -> bool:
        """Tell whether the breakaway counts; filters give Coulomb friction one below a fifth of its level.

        Args:
            theta: (level, breakaway) [N·m or N].
        """
        level, breakaway = theta
        return bool(breakaway >= LEAST_BREAKAWAY * level)

    @property
    def simpler(self) -> CoulombFriction:
        """Friction of one level, where the breakaway does not count."""
        return CoulombFriction(self.joint)

    def shape_grid(self, x: State) -> Sequence[Self]:
        """Return decays wide beside the smoothing of sgn and narrow beside the speeds driven.

        Args:
            x: Motion and torques, N samples.
        """
        return [self.with_shape(decay=d) for d in stribeck_decays(x, self.joint, 6)]


@dataclass(frozen=True)
class AsymmetricFriction(JointEffect):
    """Coulomb and viscous friction that differ by direction, f = −(α± sgn q̇ + β± q̇) ([Thesis] Table 2)."""

    name: ClassVar[str] = "asymmetric_friction"
    equation: ClassVar[str] = "−(α± sgn(q̇) + β± q̇)"
    traits: ClassVar[Traits] = Traits(
        {Signal.VELOCITY, Signal.DIRECTION}, dissipative=True, sensed=SensedFrom.MOTOR
    )
    parameters = (
        Parameter("level_positive", "{effort}", lower=0.0),
        Parameter("level_negative", "{effort}", lower=0.0),
        Parameter("coefficient_positive", VISCOUS, lower=0.0),
        Parameter("coefficient_negative", VISCOUS, lower=0.0),
    )

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the columns of both levels, then of both coefficients.

        Args:
            x: Signals of the joint, N samples.
        """
        forth, back = np.maximum(x.sign, 0.0), np.minimum(x.sign, 0.0)
        return (-forth, -back, -np.maximum(x.v, 0.0), -np.minimum(x.v, 0.0))


@dataclass(frozen=True)
class QuadraticFriction(JointEffect):
    """Windage and drag, f = −α |q̇| q̇."""

    name: ClassVar[str] = "quadratic_friction"
    equation: ClassVar[str] = "−α |q̇| q̇"
    traits: ClassVar[Traits] = Traits({Signal.VELOCITY}, dissipative=True, sensed=SensedFrom.MOTOR)
    parameters = (Parameter("coefficient", "{effort}·s²/{position}²", lower=0.0),)

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the column of the coefficient.

        Args:
            x: Signals of the joint, N samples.
        """
        return (-np.abs(x.v) * x.v,)


@dataclass(frozen=True)
class LoadFriction(JointEffect):
    """Dry friction that grows with the transmitted torque, f = −α |τ| sgn q̇ [Hamon2010]."""

    name: ClassVar[str] = "load_friction"
    equation: ClassVar[str] = "−α |τ| sgn(q̇)"
    traits: ClassVar[Traits] = Traits(
        {Signal.TORQUE, Signal.DIRECTION}, dissipative=True, sensed=SensedFrom.MOTOR
    )
    parameters = (Parameter("coefficient", "1", lower=0.0, upper=1.0),)

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the column of the coefficient.

        Args:
            x: Signals of the joint, N samples.
        """
        return (-np.abs(x.effort) * x.sign,)


@dataclass(frozen=True)
class CoupledFriction(Effect):
    """Friction between two joints that share a gear, f = −(c s + l sgn s) on both, s = q̇ᵢ + q̇ⱼ.

    Attributes:
        joint: Name of the first joint.
        other: Name of the second joint.
    """

    joint: str
    other: str

    name: ClassVar[str] = "coupled_friction"
    equation: ClassVar[str] = "−c (q̇ᵢ + q̇ⱼ) − l sgn(q̇ᵢ + q̇ⱼ) on both joints"
    traits: ClassVar[Traits] = Traits(
        {Signal.VELOCITY, Signal.DIRECTION}, dissipative=True, sensed=SensedFrom.MOTOR
    )
    scope_fields: ClassVar[tuple[str, ...]] = ("joint", "other")
    parameters = (Parameter("coefficient", VISCOUS, lower=0.0), Parameter("level", "{effort}", lower=0.0))

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.joint == self.other:
            raise EffectError(f"{self.name} takes two different joints, given {self.joint} twice")

    def check(self, robot: RobotModel) -> None:
        """Make sure that both joints are of the robot, and turn or slide alike: their speeds are added.

        Args:
            robot: The arm, n joints.
        """
        super().check(robot)
        i, j = self.acts_on(robot)
        if robot.is_prismatic[i] != robot.is_prismatic[j]:
            raise EffectError(f"{self.label}: a revolute and a prismatic joint cannot share a gear")

    def basis(self, x: State) -> Array:
        """Return Φ, alike in the rows of both joints, shape (N, n, 2).

        Args:
            x: Motion and torques, N samples.
        """
        i, j = self.acts_on(x.robot)
        shared = x.v[:, i] + x.v[:, j]
        width = np.hypot(*np.broadcast_to(x.sign_width, (x.robot.n,))[[i, j]])
        out = np.zeros((len(x), x.robot.n, 2))
        sign = smooth_sign(shared, width, x.a[:, i] + x.a[:, j], x.sampled_every)
        columns = np.column_stack([-shared, -sign])
        out[:, i, :] = columns
        out[:, j, :] = columns
        return out

    def acts_on(self, robot: RobotModel) -> tuple[int, ...]:
        """Return the indices of both joints.

        Args:
            robot: The arm, n joints.
        """
        return (robot.joint_index(self.joint), robot.joint_index(self.other))

    @classmethod
    def scopes(cls, robot: RobotModel) -> Iterator[tuple[str, ...]]:
        """Yield each pair of neighbouring joints of one kind.

        Args:
            robot: The arm, n joints.
        """
        for i in range(robot.n - 1):
            if robot.is_prismatic[i] == robot.is_prismatic[i + 1]:
                yield (robot.joints[i], robot.joints[i + 1])
