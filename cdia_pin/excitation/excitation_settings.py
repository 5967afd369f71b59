"""Settings of a designed motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from cdia_pin.errors import RobotError
from cdia_pin.phrases import settings_repr

SHORTEST = 6.0  # shortest motion [s], because less leaves no time to move and to stop


@dataclass(frozen=True, repr=False)
class ExcitationSettings:
    """Limits of a designed motion, and assumptions of the search.

    Attributes:
        duration: Length [s].
        rate: Samples per second [Hz].
        speed: Share of the velocity limits that may be used [1].
        effort: Share of the effort limits that may be used [1].
        acceleration: Largest acceleration, of all joints or by joint [rad/s² or m/s²]; without it, a joint reaches its
            speed limit in half a second.
        clearance: Distance that links keep from each other and from the floor [m].
        floor: Height of a floor above the base's origin, against gravity [m]; ``base`` for the plane on which the base
            stands; None for no floor.
        srdf: SRDF file; its disabled pairs of links are not checked for contact. Neighbours are never checked.
        size: Assumed RMS torque of an effect without parameters in the model, over that of its joint [1].
        noise: Standard deviation of the torque noise over the RMS torque [1].
        seed: Seed of the search.
        draws: Number of motions that are drawn.
        refinements: Number of variations of the best motion that are tried.
    """

    duration: float = 30.0
    rate: float = 250.0
    speed: float = 0.8
    effort: float = 0.8
    acceleration: float | Mapping[str, float] | None = None
    clearance: float = 0.01
    floor: float | Literal["base"] | None = "base"
    srdf: Path | None = None
    size: float = 0.1
    noise: float = 0.01
    seed: int = 0
    draws: int = 40
    refinements: int = 160

    __repr__ = settings_repr

    def __post_init__(self) -> None:
        if not SHORTEST <= self.duration <= 600 or not 10 <= self.rate <= 10_000:
            raise RobotError(
                f"a motion must last {SHORTEST:g} to 600 s at 10 to 10000 Hz, given {self.duration:g} s at "
                f"{self.rate:g} Hz"
            )
        if not (0 < self.size <= 1 and 0 < self.noise <= 1):
            raise RobotError(
                f"size and noise are shares of the torque and must be above 0 and at most 1, given {self.size:g} and "
                f"{self.noise:g}"
            )
        if self.seed < 0 or self.draws < 1 or self.refinements < 0:
            raise RobotError(
                f"seed and refinements must be 0 or more and draws at least 1, given seed {self.seed}, "
                f"{self.draws} draws, {self.refinements} refinements"
            )
