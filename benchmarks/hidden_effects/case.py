"""A case: which effects are hidden in which arm, how large, how it moves, and what its sensors do."""

from __future__ import annotations

from dataclasses import dataclass
from zlib import crc32

import numpy as np

from benchmarks.plant.noise import Noise

NOISES = {
    "white": Noise(),
    "coloured": Noise(colour="ar1", effort_fraction=0.02),
    "quantised": Noise(position_resolution=2e-4, effort_fraction=0.005, effort_resolution=0.02),
}
COUNTS = (12, 13, 14, 16, 17, 19)  # bits of an encoder: counts of a turn are a power of two
ENCODERS = {
    f"2^{bits} counts": Noise(position_resolution=2 * np.pi / 2**bits, effort_fraction=0.005)
    for bits in COUNTS
}
SENSORS = NOISES | ENCODERS
GOOD = "good"
POOR = ("one joint", "slow", "one posture", "single speed", "one way", "planar")
BETWEEN_POINTS = "point to point"
DURATION, SHORT = 36.0, 12.0  # [s], of a motion, and of one that is poor


@dataclass(frozen=True)
class Case:
    """A run to be made; what its name leaves open is drawn from a seed that the name gives.

    Attributes:
        suite: Kind of case, see `cases`.
        arm: Name of the arm in the catalogue.
        effects: Names of the hidden effects.
        shares: Size of each, RMS torque over that of its joint [1].
        noise: One of `SENSORS`.
        excitation: ``good``, ``point to point`` or one of `POOR`.
        number: Tells apart cases that are otherwise alike.
        model_error: Largest relative error of masses, centres and inertias of all links [1].
    """

    suite: str
    arm: str
    effects: tuple[str, ...]
    shares: tuple[float, ...]
    noise: str
    excitation: str = GOOD
    number: int = 0
    model_error: float = 0.0

    @property
    def id(self) -> str:
        """Name that stays the same, such as ``ur5/single/coulomb_friction 10%/white/good/0``."""
        hidden = (
            " + ".join(f"{e} {s:.0%}" for e, s in zip(self.effects, self.shares, strict=True)) or "nothing"
        )
        return f"{self.arm}/{self.suite}/{hidden}/{self.noise}/{self.excitation}/{self.number}"

    @property
    def duration(self) -> float:
        """Length of the log [s]."""
        return SHORT if self.excitation in POOR and self.effects else DURATION

    @property
    def cut(self) -> float:
        """Time left out at both ends of the log, so that it begins and ends in motion [s]."""
        return 1.5 if self.excitation in {"one way", "one joint"} else 0.0

    @property
    def seed(self) -> int:
        """Seed of joints, motion and noise."""
        return crc32(self.id.encode())
