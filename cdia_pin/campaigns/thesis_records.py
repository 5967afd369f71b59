"""Records of the thesis' numerical studies, as ``cdia study thesis --json`` writes them."""

from __future__ import annotations

from typing import TypedDict


class CaseRecord(TypedDict):
    """A case in JSON.

    Attributes:
        name: Name of the case.
        since: Start of the comparison of tracking [s].
        detected_after: Time from the first onset to its detection [s]; None if there was none.
        not_accommodated: Joints that track no better with the engine.
        tracking_rms: RMS position error by run and joint [rad or m].
    """

    name: str
    since: float
    detected_after: float | None
    not_accommodated: list[str]
    tracking_rms: dict[str, dict[str, float]]


class PresetRecord(TypedDict):
    """A preset in JSON: its description and the records of its cases."""

    about: str
    cases: list[CaseRecord]


class ThesisStudyRecord(TypedDict):
    """The study in JSON, schema ``cdia-study-thesis/1``.

    Attributes:
        schema: Name of the schema.
        robot: Name of the robot.
        joints: Names of the joints.
        units: Unit of position by joint.
        presets: Records by the name of the preset.
        isolation: Attributes of each `Isolation`, with ``isolated`` and ``preferred``.
    """

    schema: str
    robot: str
    joints: list[str]
    units: dict[str, str]
    presets: dict[str, PresetRecord]
    isolation: list[dict[str, object]]
