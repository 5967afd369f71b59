"""The JSON of an identification, and the record that says how to run it again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, TypedDict

from cdia_pin.logs.motion import MotionRecord

ByJoint = dict[str, float]  # one number per joint, by the joint's name


class IdentificationRecord(TypedDict):
    """What an identification was made from, and its settings."""

    version: str
    logs: list[MotionRecord]
    holdout: list[MotionRecord]
    blocks: int
    strength: float | Literal["cross-validated"]
    refine: bool


class BaseParameterJson(TypedDict):
    """One base parameter; ``told`` says whether the logs identify it."""

    name: str
    unit: str
    grouped: int
    urdf: float
    value: float
    ci95: list[float]
    told: bool


class ErrorsJson(TypedDict):
    """RMS residuals by joint [N·m or N], of the model as given and of the identified one."""

    before: ByJoint
    after: ByJoint


class IdentificationJson(TypedDict):
    """An identification in JSON, schema ``cdia-identification/1``; keys as the attributes of `Identification`."""

    schema: str
    robot: str
    joints: list[str]
    torque_rms: ByJoint
    rms: ErrorsJson
    heldout_torque_rms: ByJoint
    heldout_rms: ErrorsJson
    terms: list[Mapping[str, Any]]  # as `Term` describes itself
    refined: list[str]
    inertial_parameters: dict[str, list[float]]
    physical_margin: ByJoint
    base_parameters: list[BaseParameterJson]
    strength: float
    record: IdentificationRecord
