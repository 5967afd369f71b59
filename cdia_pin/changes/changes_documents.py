"""The JSON of changes, and the record that says how to look for them again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NotRequired, TypedDict

from cdia_pin.changes.phenomenon import PhenomenonJson
from cdia_pin.changes.run_to_run import UsualFrictionJson
from cdia_pin.logs.motion import MotionRecord
from cdia_pin.selection.discovery_settings import SearchRecord

ByJoint = dict[str, float]  # one number per joint, by the joint's name


class ChangesRecord(SearchRecord):
    """What changes were looked for in, and with which settings."""

    version: str
    before: list[MotionRecord]
    after: list[MotionRecord]
    blocks: int


class ChangeJson(TypedDict):
    """A change in JSON; keys as the attributes of `Change`, descriptions as those of `Effect` and `Term`."""

    effect: str
    joints: list[str]
    shape: NotRequired[Mapping[str, Any]]
    difference: Mapping[str, Any]
    before: dict[str, float] | None
    growth: float | None
    torque_rms: ByJoint
    evidence: float
    confidence: str
    confusable_with: list[Mapping[str, Any]]


class UncertainJson(TypedDict):
    """What is too uncertain to be named, in JSON; share of the certainty that a name needs [1]."""

    effect: str
    joints: list[str]
    difference: Mapping[str, Any]
    share: float


class BoundJson(TypedDict):
    """The largest change of one kind that the logs would not show; torque in N·m or N, and over the joint's."""

    effect: str
    parameters: Mapping[str, Any]
    torque_rms: float
    share: float


class RmsOfSides(TypedDict):
    """RMS residuals by joint [N·m or N], in the logs before and after."""

    before: ByJoint
    after: ByJoint


class ChangesJson(TypedDict):
    """Changes in JSON, schema ``cdia-changes/1``; keys as the attributes of `Changes`."""

    schema: str
    robot: str
    joints: list[str]
    before: list[str]
    after: list[str]
    verdict: str
    changes: list[ChangeJson]
    bounds: dict[str, BoundJson]
    not_compared: dict[str, str]
    uncertain: list[UncertainJson]
    usual_friction: list[UsualFrictionJson]
    spread: float
    findings: list[PhenomenonJson]
    rms: RmsOfSides
    record: ChangesRecord
