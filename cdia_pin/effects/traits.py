"""Traits: what is true of an effect's physics, stated once and checked by the contract tests."""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass
from enum import StrEnum


class Channel(StrEnum):
    """Where an effect enters the equation."""

    JOINT_TORQUE = "joint torque"  # adds torque to the arm
    POSITION_READING = "position reading"  # the arm is at q + `Effect.shift`
    TORQUE_READING = "torque reading"  # distorts the reading, after all else and in proportion to the torque


class SensedFrom(StrEnum):
    """Side of the gear on which a torque sensor must be so that a search looks for an effect."""

    EITHER = "either side"
    MOTOR = "motor side"  # a sensor behind the gear does not see it
    BEHIND = "behind the gear"  # one before the gear sees it as a part of something larger

    @classmethod
    def of(cls, behind_the_gear: bool) -> SensedFrom:
        """Return the side of a sensor.

        Args:
            behind_the_gear: Whether it is known to be there.
        """
        return cls.BEHIND if behind_the_gear else cls.MOTOR

    def meets(self, other: SensedFrom) -> bool:
        """Return False if no search looks for both, because they need the sensor on different sides.

        Args:
            other: Side of another effect, or of a sensor.
        """
        return {self, other} != {SensedFrom.MOTOR, SensedFrom.BEHIND}


class Signal(StrEnum):
    """What Φ can depend on, as a `State` holds it."""

    POSITION = "position"
    VELOCITY = "velocity"
    DIRECTION = "direction"  # sgn q̇, smoothed over `State.sign_width`
    ACCELERATION = "acceleration"  # Φ is affine in it
    TORQUE = "torque"  # of the actuator; what acts on the arm is in proportion to it, for either sign
    TIME = "time"
    TEMPERATURE = "temperature"  # of the joint, where a log has it
    GRAVITY = "gravity"  # that bodies on the arm feel, `State.gravity`


@dataclass(frozen=True)
class Traits:
    """What is true of an effect's physics.

    Attributes:
        depends_on: Signals that change Φ; all others leave it as it is.
        channel: Where the effect enters the equation.
        linear: Whether f is linear in θ; `NonlinearEffect` is the base of those that are not.
        dissipative: Whether f · q̇ ≤ 0 for all parameters within their bounds, as in friction.
        turns_gravity: Whether bodies on the arm feel another gravity, by `Effect.gravity_change`.
        sensed: From which side of the gear it is looked for. Friction of a drive and a rotor act between the motor
            and the output of its gear, so a torque sensor behind the gear does not see them.
    """

    depends_on: Set[Signal] = frozenset()
    channel: Channel = Channel.JOINT_TORQUE
    linear: bool = True
    dissipative: bool = False
    turns_gravity: bool = False
    sensed: SensedFrom = SensedFrom.EITHER

    def __post_init__(self) -> None:
        object.__setattr__(self, "depends_on", frozenset(self.depends_on))  # hashable
