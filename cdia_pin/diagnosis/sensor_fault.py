"""`SensorFault`: a sensor whose readings cannot be those of the arm, as opposed to a fault of the arm itself."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class SensorSignal(StrEnum):
    """What a sensor measures."""

    POSITION = "position"
    VELOCITY = "velocity"
    TORQUE = "torque"
    TIME = "time"  # the clock; it has no joint


class SensorCondition(StrEnum):
    """What is wrong with a sensor."""

    FROZEN = "frozen"  # the value stays the same while the arm moves; also a dead sensor, which says zero
    SHIFTED = "shifted"  # the value has jumped and stays off by a constant
    BIASED = "biased"  # velocity and position of the joint contradict each other
    OUTSIDE = "outside"  # no finite number, or one beyond what the arm can do
    ERRATIC = "erratic"  # jump after jump


WORDS = {
    SensorSignal.POSITION: "encoder",
    SensorSignal.VELOCITY: "velocity sensor",
    SensorSignal.TORQUE: "torque sensor",
    SensorSignal.TIME: "clock",
}


@dataclass(frozen=True)
class SensorFault:
    """A fault of a sensor.

    Attributes:
        joint: Name of the joint; None for the clock.
        signal: What the sensor measures.
        condition: What is wrong with it.
        since: Time from which on it has been wrong [s].
        offset: Shift of a position that is subtracted from its readings [rad or m]; 0 for other conditions.
    """

    joint: str | None
    signal: SensorSignal
    condition: SensorCondition
    since: float
    offset: float = 0.0

    @property
    def name(self) -> str:
        """Words for the sensor, such as ``encoder of joint3``."""
        return WORDS[self.signal] + (f" of {self.joint}" if self.joint else "")

    def __str__(self) -> str:
        limited = ", or its drive stands at its limit" if self.signal is SensorSignal.TORQUE else ""
        said = {
            SensorCondition.FROZEN: f"is frozen or dead{limited}: its value stays the same while the arm moves",
            SensorCondition.SHIFTED: f"jumped and is off by {self.offset:+.4g}, which is subtracted",
            SensorCondition.BIASED: "contradicts the positions",
            SensorCondition.OUTSIDE: "gives values that cannot be",
            SensorCondition.ERRATIC: "jumps as no motion does",
        }[self.condition]
        return f"{self.name} {said}"
