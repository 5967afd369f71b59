"""What a monitor reports: a status at each tick, and an event whenever its diagnosis changes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any, NotRequired, TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.sensor_fault import SensorFault
from cdia_pin.effects import Term
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


class Stage(StrEnum):
    """Stage of a joint between healthy and accommodated ([Thesis] fig. 6); later members are graver."""

    HEALTHY = "healthy"
    IDLE = "idle"  # a fault has cleared, and is remembered
    SUSPECT = "suspect"  # the residual is beyond the threshold, but not yet for long enough
    ACCOMMODATED = "accommodated"  # the fault is isolated and compensated
    ISOLATED = "isolated"  # the fault is isolated, and not compensated
    DETECTED = "detected"  # there is a fault, and isolation goes on


_GRAVITY = {stage: k for k, stage in enumerate(Stage)}


class Verdict(StrEnum):
    """Result of isolation."""

    UNIQUE = "unique"  # one combination of known effects explains the fault
    AMBIGUOUS = "ambiguous"  # several combinations explain it equally well
    UNKNOWN = "unknown"  # no combination explains it
    NONE = "none"  # there is no fault


class EventStage(StrEnum):
    """Stage of the scheme that an event belongs to."""

    DETECTION = "detection"
    ISOLATION = "isolation"
    ACCOMMODATION = "accommodation"
    IDLE = "idle"  # a fault has cleared, or is present only in a region of the motion
    SENSOR = "sensor"  # a sensor is at fault, or can be trusted again; the arm is not concerned


NO_CONTACT = "it was no contact"  # reason for which a contact ends that turned out to be something else
WITHDRAWN = (
    "another cause explains all samples better"  # reason for which a wrong belief of the whole arm ends
)
LASTS = "small, but it lasts"  # reason of a detection by the second detector, below the threshold


class FaultDict(TypedDict):
    """A fault in files of the schema cdia-events/1."""

    effect: str
    joint: str | None
    parameters: dict[str, Any]
    shape: NotRequired[dict[str, float]]
    profile: NotRequired[dict[str, Any]]


class EventDict(TypedDict):
    """An event in files of the schema cdia-events/1."""

    time: float
    stage: str
    joints: list[str]
    status: str
    faults: list[FaultDict]
    alternatives: list[list[FaultDict]]
    reason: str


@dataclass(frozen=True, repr=False)
class Event:
    """A change of the diagnosis.

    Attributes:
        time: Time of the change [s].
        stage: Stage of the scheme: detection, isolation, accommodation, idle for a cleared fault; or sensor.
        joints: Names of the joints concerned.
        verdict: Result of isolation.
        faults: The effects with parameters and intervals; of equal combinations the likeliest.
        alternatives: Other combinations that explain the residual equally well.
        reason: A remark for the reader, or empty.
    """

    time: float
    stage: EventStage
    joints: tuple[str, ...]
    verdict: Verdict
    faults: tuple[Term, ...] = ()
    alternatives: tuple[tuple[Term, ...], ...] = ()
    reason: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "stage", EventStage(self.stage))

    def __repr__(self) -> str:
        faults = ", ".join(t.label for t in self.faults[:2]) + (", …" if len(self.faults) > 2 else "")
        joints = ", ".join(self.joints[:2]) + (", …" if len(self.joints) > 2 else "")
        return f"Event({self.time:.3f} s, {self.stage}, {joints}, {self.verdict}{': ' if faults else ''}{faults})"

    def to_dict(self, robot: RobotModel) -> EventDict:
        """Return the event as files of the schema cdia-events/1 have it.

        Args:
            robot: The arm, for the units of parameters.
        """
        return {
            "time": self.time,
            "stage": str(self.stage),
            "joints": list(self.joints),
            "status": str(self.verdict),
            "faults": [fault_to_dict(t, robot) for t in self.faults],
            "alternatives": [[fault_to_dict(t, robot) for t in one] for one in self.alternatives],
            "reason": self.reason,
        }


@dataclass(
    slots=True, eq=False, repr=False
)  # one is made at every tick: frozen, it would take four times as long
class Status:
    """Diagnosis after a tick; arrays are in the order of the robot's joints, shape (n,).

    Attributes:
        time: Time of the tick [s].
        stages: Stage of each joint.
        residual: Filtered torque that the model lacks [N·m or N]; of the engine ``thesis`` the velocity error of
            its observer [rad/s or m/s].
        threshold: Bound of a healthy arm's residual, in the same unit.
        torque_correction: Torque to add to the nominal one, so that the arm moves as if healthy [N·m or N].
        faults: Believed faults with their parameters.
        events: Changes at this tick; mostly none.
        blind: Names of the joints whose threshold is too wide to see a fault of 30 % of their torque.
        sensors: Sensors that are at fault.
        warnings: What the monitor itself cannot do now, such as write its event log; mostly none.
    """

    time: float
    stages: tuple[Stage, ...]
    residual: Array
    threshold: Array
    torque_correction: Array
    faults: tuple[Term, ...] = ()
    events: tuple[Event, ...] = ()
    blind: tuple[str, ...] = ()
    sensors: tuple[SensorFault, ...] = ()
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return (
            f"Status({self.time:.3f} s, {self.stage}, {len(self.faults)} faults, {len(self.events)} events)"
        )

    @property
    def stage(self) -> Stage:
        """The gravest stage of any joint."""
        return max(self.stages, key=_GRAVITY.__getitem__)


def fault_to_dict(term: Term, robot: RobotModel) -> FaultDict:
    """Return one fault as files of the schema cdia-events/1 have it.

    Args:
        term: The fault.
        robot: The arm, for the units of parameters.
    """
    out: FaultDict = {
        "effect": term.effect.name,
        "joint": term.effect.scope[0] if term.effect.scope else None,
        "parameters": term.parameters_to_dict(robot),
    }
    if term.effect.shape_values:
        out["shape"] = term.effect.shape_values
    if term.profile.kind != "always":
        out["profile"] = term.profile.to_dict()
    return out
