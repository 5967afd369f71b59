"""Phenomena: what several numbers mean together, in a sentence."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TypedDict

from cdia_pin.phrases import clipped, some


class PhenomenonKind(StrEnum):
    """What can be recognised."""

    WARMING = "warming"
    COOLING = "cooling"
    DRIFT = "drift"
    MEMORY = "memory"
    RUN_TO_RUN = "run-to-run"
    RECORDER = "recorder"


class PhenomenonJson(TypedDict):
    """A phenomenon in JSON; keys as the attributes of `Phenomenon`."""

    kind: str
    joints: list[str]
    sentence: str
    values: dict[str, float]


@dataclass(frozen=True, repr=False)
class Phenomenon:
    """A cause that shows in several effects, or a pattern of the residual that no effect describes.

    Attributes:
        kind: What it is.
        joints: Names of the joints concerned.
        sentence: What was recognised, with its numbers, for people.
        values: The numbers by name, in the unit of the sentence; a share such as ``median_growth`` has none [1].
    """

    kind: PhenomenonKind
    joints: tuple[str, ...]
    sentence: str
    values: dict[str, float]

    def __repr__(self) -> str:
        return f"Phenomenon({self.kind} on {some([clipped(j, 30) for j in self.joints], 3)})"

    def to_dict(self) -> PhenomenonJson:
        """Return the phenomenon for JSON."""
        return {
            "kind": str(self.kind),
            "joints": list(self.joints),
            "sentence": self.sentence,
            "values": self.values,
        }
