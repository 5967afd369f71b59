"""The JSON of a designed motion, and the record that says how to design it again."""

from __future__ import annotations

from typing import TypedDict


class ExcitationRecord(TypedDict):
    """The settings of a design, see `ExcitationSettings`, and the labels of the model's terms."""

    version: str
    duration: float
    rate: float
    speed: float
    effort: float
    acceleration: float | dict[str, float] | None
    clearance: float
    floor: float | str | None
    srdf: str | None
    size: float
    noise: float
    seed: int
    draws: int
    refinements: int
    terms: list[str]


class PeakJson(TypedDict):
    """The largest value of a signal on the motion, and its limit, in the unit of the signal."""

    peak: float
    limit: float


class CollisionsJson(TypedDict):
    """What was checked for contact: distance kept [m], height of the floor [m], pairs of shapes."""

    clearance: float
    floor: float | None
    pairs: int


class SeenJson(TypedDict):
    """How many combinations of parameters any motion shows, of how many parameters."""

    combinations: int
    parameters: int


class GainJson(TypedDict):
    """What the motion makes visible; keys as the attributes of `Gain`."""

    between: list[str]
    before: float
    after: float
    enough: bool
    seen: SeenJson


class ExcitationJson(TypedDict):
    """A designed motion in JSON, schema ``cdia-excitation/1``; the samples are in the CSV file."""

    schema: str
    robot: str
    joints: list[str]
    duration: float
    limits: dict[str, dict[str, PeakJson]]
    start: dict[str, float]
    collisions: CollisionsJson
    gain: GainJson
    warnings: list[str]
    record: ExcitationRecord
