"""The JSON of a comparison and of a discovery, and the records that say how to run them again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NotRequired, TypedDict

from cdia_pin.changes.phenomenon import PhenomenonJson
from cdia_pin.identifiability.confusion import ConfusionJson
from cdia_pin.logs.motion import MotionRecord
from cdia_pin.selection.discovery_settings import SearchRecord

ByJoint = dict[str, float]  # one number per joint, by the joint's name


class ComparisonRecord(TypedDict):
    """What a comparison was made from."""

    version: str
    logs: list[MotionRecord]


class DiscoveryRecord(SearchRecord):
    """What a discovery was made from, and its settings."""

    version: str
    logs: list[MotionRecord]
    holdout: list[MotionRecord]
    blocks: int
    per_log: list[str]
    most_effects: int


class RegionJson(TypedDict):
    """A region in JSON; keys as the attributes of `ResidualRegion`."""

    joint: str
    signal: str
    lower: float
    upper: float
    rms: float
    bias: float
    ratio: float
    unit: str


class ComparisonJson(TypedDict):
    """A comparison in JSON, schema ``cdia-comparison/1``; keys as the attributes of `Comparison`."""

    schema: str
    robot: str
    joints: list[str]
    rms: ByJoint
    relative_rms: ByJoint
    torque_rms: ByJoint
    bias: ByJoint
    autocorrelation: ByJoint
    worst_regions: list[RegionJson]
    record: ComparisonRecord


class FoundEffectJson(TypedDict):
    """An effect that was found, as `Effect` and `Term` describe themselves, and other explanations."""

    effect: str
    joints: list[str]
    parameters: Mapping[str, Any]
    shape: NotRequired[Mapping[str, Any]]
    varies: NotRequired[Mapping[str, Any]]
    confusable_with: list[ConfusionJson]
    confidence: NotRequired[str]
    group: NotRequired[str]
    change_of_model: NotRequired[bool]


class BeforeAfter(TypedDict):
    """RMS errors by joint [N·m or N], without and with an effect."""

    before: ByJoint
    after: ByJoint


class RankedJson(FoundEffectJson):
    """What one candidate would explain by itself."""

    heldout_rms: BeforeAfter


class TraceStepJson(TypedDict):
    """One step of the trace; ``added`` is None for the model as given."""

    added: str | None
    rms: ByJoint
    heldout_rms: ByJoint


class DiscoveryJson(TypedDict):
    """A discovery in JSON, schema ``cdia-discovery/1``; keys as the attributes of `Discovery`."""

    schema: str
    robot: str
    joints: list[str]
    verdict: str
    effects: list[FoundEffectJson]
    trace: list[TraceStepJson]
    noise_floor: ByJoint
    torque_rms: ByJoint
    heldout_torque_rms: ByJoint
    compared_share: ByJoint
    structure_left: list[str]
    held: list[str]
    resting: list[str]
    ranking: list[RankedJson]
    capability: Mapping[str, Any]
    findings: list[PhenomenonJson]
    record: DiscoveryRecord
