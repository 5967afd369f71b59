"""Findings: what numbers mean together, in a sentence."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Finding:
    """Something recognised that is more than one effect, or less.

    Attributes:
        kind: Its name, such as ``warming``.
        joints: Where.
        sentence: What was recognised, with its numbers, for people.
        values: The numbers, by name with the unit in it.
    """

    kind: str
    joints: tuple[str, ...]
    sentence: str
    values: dict[str, float]

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-ready description."""
        return {
            "kind": self.kind,
            "joints": list(self.joints),
            "sentence": self.sentence,
            "values": self.values,
        }
