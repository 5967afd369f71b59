"""What sits between the drive's torque and the joint: gain, offset, rotor, spring, ripple."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.joint_effect import JointEffect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.state import JointState, State
from cdia_pin.effects.traits import SensedFrom, Signal, Traits

Array = NDArray[np.float64]

FASTEST_TURNING = 60.0  # [1/rad], the fastest ripple that is searched for: poles of a motor, teeth of a gear
FASTEST_SLIDING = 400.0  # [1/m], the same of a slide: pulleys and screws whose turn is 16 mm or more
OF_A_GEAR = (
    5.0  # [1/rad or 1/m], what repeats that often is called a ripple before two periods of it are seen
)
TURN = 2 * np.pi
LEAST_TRAVEL = 1e-3  # [rad or m], of a joint that shows a ripple


@dataclass(frozen=True)
class ActuatorGain(JointEffect):
    """The drive delivers more or less than asked, f = α τ, α > −1 ([Thesis] Table 3)."""

    name: ClassVar[str] = "actuator_gain"
    equation: ClassVar[str] = "α τ"
    traits: ClassVar[Traits] = Traits({Signal.TORQUE})
    parameters = (Parameter("gain", "1", lower=-0.999, upper=10.0),)

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the column of the gain.

        Args:
            x: Signals of the joint, N samples.
        """
        return (x.effort,)


@dataclass(frozen=True)
class TorqueOffset(JointEffect):
    """A constant torque: a sensor's zero, a balancer, f = c."""

    name: ClassVar[str] = "torque_offset"
    equation: ClassVar[str] = "c"
    traits: ClassVar[Traits] = Traits()
    parameters = (Parameter("offset", "{effort}"),)

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the column of the offset.

        Args:
            x: Signals of the joint, N samples.
        """
        return (1.0 + 0.0 * x.q,)  # one, for numbers as for arrays


@dataclass(frozen=True)
class RotorInertia(JointEffect):
    """Inertia of rotor and gear seen at the joint, f = −I q̈."""

    name: ClassVar[str] = "rotor_inertia"
    equation: ClassVar[str] = "−I q̈"
    traits: ClassVar[Traits] = Traits({Signal.ACCELERATION}, sensed=SensedFrom.MOTOR)
    parameters = (Parameter("inertia", "{inertia}", lower=0.0),)

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the column of the inertia.

        Args:
            x: Signals of the joint, N samples.
        """
        return (-x.a,)


@dataclass(frozen=True)
class JointSpring(JointEffect):
    """A spring or cable pulling the joint to a place, f = −k q + c."""

    name: ClassVar[str] = "joint_spring"
    equation: ClassVar[str] = "−k q + c"
    traits: ClassVar[Traits] = Traits({Signal.POSITION})
    parameters = (Parameter("stiffness", "{effort}/{position}", lower=0.0), Parameter("preload", "{effort}"))

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the columns of stiffness and preload.

        Args:
            x: Signals of the joint, N samples.
        """
        return (-x.q, 1.0 + 0.0 * x.q)  # one, for numbers as for arrays


@dataclass(frozen=True)
class PositionRipple(JointEffect):
    """Torque that repeats along the joint, f = a sin(w₀ q) + b cos(w₀ q) ([Thesis] Table 2).

    Cogging of a motor, teeth of a gear; k sin(w₀ q + φ) with k² = a² + b² and φ = atan2(b, a).

    Attributes:
        frequency: w₀, radians of ripple per radian of joint [1/rad or 1/m].
    """

    frequency: float = 7.0

    name: ClassVar[str] = "position_ripple"
    equation: ClassVar[str] = "a sin(w₀ q) + b cos(w₀ q)"
    traits: ClassVar[Traits] = Traits({Signal.POSITION})
    parameters = (Parameter("sine", "{effort}"), Parameter("cosine", "{effort}"))
    shape = (Parameter("frequency", "1/{position}", lower=0.1, upper=1e3),)

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the sine and cosine columns.

        Args:
            x: Signals of the joint, N samples.
        """
        return (np.sin(self.frequency * x.q), np.cos(self.frequency * x.q))

    def shape_grid(self, x: State) -> Sequence[Self]:
        """Return frequencies that can be a ripple on the range driven, finely enough to miss none.

        Either two periods of it are seen, or half a period and it is as fast as what motors and gears make. Of a
        smaller part nobody knows how large the whole is.

        Args:
            x: Motion and torques, N samples.
        """
        j, travel = x.robot.joint_index(self.joint), self._travel(x)
        if travel < LEAST_TRAVEL:
            return []
        fastest = FASTEST_SLIDING if x.robot.is_prismatic[j] else FASTEST_TURNING
        slowest = max(float(np.clip(OF_A_GEAR, TURN / 2 / travel, 2 * TURN / travel)), self.shape[0].lower)
        step = 0.35 * TURN / travel  # a third of a resolution cell
        return [self.with_shape(frequency=float(w)) for w in np.arange(slowest, fastest, step)]

    def nearly_alike(self, x: State) -> Sequence[Self]:
        """Return the ripples one resolution cell slower and faster; with them its size may change along the joint.

        Args:
            x: Motion and torques, N samples.
        """
        travel, least = self._travel(x), self.shape[0].lower
        beside = (self.frequency - TURN / travel, self.frequency + TURN / travel) if travel > 0 else ()
        return [self.with_shape(frequency=w) for w in beside if least <= w <= self.shape[0].upper]

    def _travel(self, x: State) -> float:
        return float(np.ptp(x.q[:, x.robot.joint_index(self.joint)]))
