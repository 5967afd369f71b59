"""What came of a monitored log."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import Any, ClassVar

import numpy as np

from benchmarks.outcomes import JsonLine


@dataclass(frozen=True)
class Outcome(JsonLine):
    """What the monitor said.

    Attributes:
        id: Of the case.
        kind: Of the case.
        arm: Name of the arm.
        effect: Label of the effect that was put in; empty for none.
        blind: Whether the monitor said beforehand that it is blind on the joints of the effect: its own, or for one of
            the whole arm all of them.
        detected: Time from its beginning to the first detection after it [s]; NaN if there was none.
        early: Detections before it, or at all where nothing was put in.
        named: Labels believed in at the end.
        sets: Sets of labels that the last isolation of each joint, and of the arm, left possible, best first.
        size_error: Error of the first parameter of the effect, if it is believed at the end, over its size [1].
        size_half: Half width of its 95 % interval, over the same [1].
        contacts: Number of contacts said.
        ever: Labels that were isolated at any time, contacts left out.
        mass: Payload's mass at the end [kg].
        mass_half: Half width of its 95 % interval [kg].
        mass_after: Time from the first detection to the payload's name [s].
        compared_mass: Mass of the payload that the comparison at the end established [kg].
        compared_half: Half width of its 95 % interval [kg].
        force_error: Median error of the contact's force against a sensor, relative [1].
        force_said: Share of the time with a force above 10 N in which contact was said [1].
        lasting: Labels that the comparison of the log's end with the healthy log established.
        lasted: Sets of labels that it left possible for each of them, best first.
        kept: Time of the log [s].
        said: All events in words.
        failure: What the program failed with; empty if it did not.
    """

    id: str
    kind: str
    arm: str
    effect: str = ""
    blind: bool = False
    detected: float = nan
    early: int = 0
    named: tuple[str, ...] = ()
    sets: tuple[tuple[tuple[str, ...], ...], ...] = ()
    size_error: float = nan
    size_half: float = nan
    contacts: int = 0
    ever: tuple[str, ...] = ()
    mass: float = nan
    mass_half: float = nan
    mass_after: float = nan
    compared_mass: float = nan
    compared_half: float = nan
    force_error: float = nan
    force_said: float = nan
    lasting: tuple[str, ...] = ()
    lasted: tuple[tuple[str, ...], ...] = ()
    kept: float = nan
    said: tuple[str, ...] = ()
    failure: str = ""

    READ: ClassVar[dict[str, Any]] = {
        "named": tuple,
        "ever": tuple,
        "said": tuple,
        "lasting": tuple,
        "lasted": lambda v: tuple(tuple(of) for of in v),
        "sets": lambda v: tuple(tuple(tuple(one) for one in of) for of in v),
    }

    @property
    def is_right(self) -> bool:
        """Whether the effect that was put in is believed at the end, or the first of those that fit alike."""
        return self.effect in self.named

    @property
    def holds(self) -> bool:
        """Whether it is among what the monitor leaves possible, alone on its joint."""
        return self.is_right or any((self.effect,) in one for one in self.sets)

    @property
    def is_within(self) -> bool:
        """Whether the 95 % interval of the effect's first parameter holds what was put in."""
        return self.size_error <= self.size_half

    @property
    def is_noticed(self) -> bool:
        """Whether it was detected, or something was established at the end."""
        return not np.isnan(self.detected) or bool(self.lasting)

    @property
    def lasts(self) -> bool:
        """Whether it is established at the end, or fits as well as what is."""
        return any(self.effect in alike for alike in self.lasted)

    @property
    def is_alone(self) -> bool:
        """Whether it is named, and nothing else."""
        return self.named == (self.effect,)
