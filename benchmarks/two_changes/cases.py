"""Every case of the benchmark; a case is a name, and its name is its seed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations
from zlib import crc32

from benchmarks.real_residuals.draws import can_be_seen
from benchmarks.real_residuals.pairs import Pair, pairs

SIZES = (10, 25)  # [%] of the joint's RMS torque, each of the two
# What changes on arms that are used: the list is short, because each effect is drawn beside each other one. A gain is
# last, because it scales the torque of the other effect too.
EVERYDAY = (
    "payload",
    "coulomb_friction",
    "viscous_friction",
    "stribeck_friction",
    "torque_offset",
    "joint_spring",
    "actuator_gain",
)
# Two that are one effect where they are on the same joint: a level of friction and friction with a level, a spring that
# is preloaded otherwise, and the two levels of asymmetric friction.
SAME = (
    {"coulomb_friction", "stribeck_friction"},
    {"torque_offset", "joint_spring"},
    {"coulomb_friction", "torque_offset"},
)
NOT_COMPARED = {"double_pendulum"}  # its two swings have no motion in common


@dataclass(frozen=True)
class Case:
    """Two effects that are put into the second log of a pair.

    Attributes:
        suite: ``tuning`` or ``reporting``.
        pair: The logs.
        effects: Names of both.
        size: Of each [%] of its joint's RMS torque.
    """

    suite: str
    pair: Pair
    effects: tuple[str, str]
    size: int

    @property
    def id(self) -> str:
        """Name that stays the same."""
        return f"{self.suite}/{self.pair.id}/{' and '.join(self.effects)} {self.size} %"

    @property
    def seed(self) -> int:
        """Seed of joints, signs and shapes."""
        return crc32(self.id.encode())

    @property
    def on_one_joint(self) -> bool:
        """Whether both are put on the same joint: in one case in two, unless they would be one effect there."""
        return self.seed % 2 == 0 and set(self.effects) not in SAME


def planned(suite: str, arms: Iterable[str], sizes: Iterable[int] = SIZES, every: int = 1) -> list[Case]:
    """Return the cases in an order that mixes them all.

    Args:
        suite: ``tuning`` or ``reporting``.
        arms: Names of arms.
        sizes: Of the effects [%].
        every: One case in so many.
    """
    chosen = set(arms) - NOT_COMPARED
    cases = [
        Case(suite, pair, two, size)
        for pair in pairs()
        if pair.takes_effects and pair.arm in chosen
        for two in combinations(EVERYDAY, 2)
        if all(can_be_seen(e, pair.arm) for e in two)
        for size in sizes
    ]
    return sorted(cases, key=lambda c: (c.seed, c.id))[::every]
