"""What a monitor is made of, as files and reports state it."""

from __future__ import annotations

from typing import Any, NotRequired, TypedDict

from cdia_pin.diagnosis.sight import JointSight, blind_advice, blind_joints


class RunSource(TypedDict):
    """Source of a log.

    Attributes:
        source: File or name.
        sha256: Hash of the file, if there is one.
        duration: Length [s].
        rate: Samples per second [Hz].
    """

    source: str
    sha256: str | None
    duration: NotRequired[float]
    rate: NotRequired[float]


class MonitorRecord(TypedDict):
    """What a monitor is made of, enough to make it again; plain JSON.

    Attributes:
        version: Version of the package.
        engine: Name of the engine.
        bank: Names of the known effects.
        settings: Settings of the engine by name.
        model: Labels of the model's terms.
        healthy: Sources of the healthy runs.
        rate: Ticks per second [Hz]; None if it was not given.
        notes: What healthy runs taught, one sentence each.
        sight: Threshold and torque of each joint, by its name; empty where thresholds are no torques.
        log: Source of the log, of a replay.
        loop: Settings of the loop, of a closed loop.
    """

    version: str
    engine: str
    bank: list[str]
    settings: dict[str, Any]
    model: list[str]
    healthy: list[RunSource]
    rate: float | None
    notes: list[str]
    sight: dict[str, JointSight]
    log: NotRequired[RunSource]
    loop: NotRequired[dict[str, Any]]


def what_is_blind(record: MonitorRecord) -> str:
    """Return a sentence on the joints that are blind, and what to do; empty if none is.

    Args:
        record: Of a monitor.
    """
    said = blind_advice(blind_joints(record["sight"]), bool(record["model"]))
    return f"{said[:1].upper()}{said[1:]}." if said else ""
