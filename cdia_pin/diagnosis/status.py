"""What a monitor says: a status each tick, and an event whenever its mind changes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Term
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


class Stage(StrEnum):
    """Where a joint stands between healthy and accommodated ([Thesis] fig. 6); later is graver."""

    HEALTHY = "healthy"
    IDLE = "idle"  # a fault was there, is gone, and is remembered
    SUSPECT = "suspect"  # the residual is beyond the threshold, not yet for long enough
    ACCOMMODATED = "accommodated"  # isolated, and the control law has been corrected
    ISOLATED = "isolated"  # known, and not corrected
    DETECTED = "detected"  # there is a fault, which one is being decided


class Verdict(StrEnum):
    """What isolation says of a fault."""

    UNIQUE = "unique"  # one combination of known effects explains it
    AMBIGUOUS = "ambiguous"  # several do, equally well
    UNKNOWN = "unknown"  # none does
    NONE = "none"  # there is no fault


@dataclass(frozen=True)
class Event:
    """A change of mind.

    Attributes:
        time: When [s].
        stage: ``detection``, ``isolation``, ``accommodation`` or ``idle``.
        joints: Joints concerned.
        verdict: What isolation says.
        faults: The effects with their sizes and intervals; of several equal combinations the likeliest.
        alternatives: Other combinations that explain the same.
        reason: In words, what a reader should know besides.
    """

    time: float
    stage: str
    joints: tuple[str, ...]
    verdict: Verdict
    faults: tuple[Term, ...] = ()
    alternatives: tuple[tuple[Term, ...], ...] = ()
    reason: str = ""

    def to_dict(self, robot: RobotModel) -> dict[str, Any]:
        """Return the event as the files of the schema cdia-events/1 have it."""
        return {
            "time": self.time,
            "stage": self.stage,
            "joints": list(self.joints),
            "status": str(self.verdict),
            "faults": [fault_to_dict(t, robot) for t in self.faults],
            "alternatives": [[fault_to_dict(t, robot) for t in one] for one in self.alternatives],
            "reason": self.reason,
        }


@dataclass(slots=True, eq=False)  # one is made at every tick: frozen, it would take four times as long
class Status:
    """What a monitor says after a tick; arrays are in the order of the robot's joints, shape (n,).

    Attributes:
        time: Time of the tick [s].
        stages: Stage of each joint.
        residual: Torque that the model lacks, filtered [N·m or N]; of the engine ``thesis`` the velocity
            error of its observer [rad/s or m/s].
        threshold: What a healthy arm's residual stays below, same unit.
        torque_correction: What to add to the nominal torque so that the arm moves as if healthy [N·m or N].
        faults: Faults now believed in, with their sizes.
        events: What changed at this tick; mostly nothing.
    """

    time: float
    stages: tuple[Stage, ...]
    residual: Array
    threshold: Array
    torque_correction: Array
    faults: tuple[Term, ...] = ()
    events: tuple[Event, ...] = ()

    @property
    def stage(self) -> Stage:
        """The gravest stage of any joint."""
        order = list(Stage)
        return max(self.stages, key=order.index)


def fault_to_dict(term: Term, robot: RobotModel) -> dict[str, Any]:
    """Return one fault as the files of the schema cdia-events/1 have it."""
    out: dict[str, Any] = {
        "effect": term.effect.name,
        "joint": term.effect.scope[0] if term.effect.scope else None,
        "parameters": term.parameters_to_dict(robot),
    }
    if term.effect.shape_values:
        out["shape"] = term.effect.shape_values
    if term.profile.kind != "always":
        out["profile"] = term.profile.to_dict()
    return out
