"""Pairs of logs of one arm: nothing changed between them, but for what the data's README says."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, permutations

from benchmarks.real_residuals.recordings import Recording


@dataclass(frozen=True)
class Pair:
    """Two logs of one arm.

    Attributes:
        before: The first, which stays as it is.
        after: The second, into which effects are put.
        takes_effects: Whether both move alike enough for an effect in the second to be told from the arm itself.
        known: Parameters of the payload that the second one has, by name and value; empty if nothing changed.
    """

    before: Recording
    after: Recording
    takes_effects: bool = True
    known: tuple[tuple[str, float], ...] = ()

    @property
    def arm(self) -> str:
        """Name of the arm."""
        return self.before.arm

    @property
    def id(self) -> str:
        """Name that stays the same."""
        return f"{self.before.id} → {self.after.id.partition('/')[2]}"


PANDA, UR10 = Recording("panda", "exciting"), Recording("ur10", "exciting")
LONG, SHORT, POINTS = (Recording("ur10e", f) for f in ("fourier_50s", "fourier_40s", "point_to_point"))
LOADED = Recording("ur10e", "loaded_2600g")
SINGLE = tuple(Recording("ur10e", f"jointwise_{k}") for k in range(1, 7))  # joint k moves, the others rest
UR5, LWR4 = Recording("ur5", "free"), Recording("kuka_lwr4", "exciting")
SWINGS = (Recording("double_pendulum", "swing_1"), Recording("double_pendulum", "swing_2"))
PAYLOAD = (("mass", 2.6),)  # [kg], on the flange of the UR10e in the loaded log


def pairs() -> list[Pair]:
    """Return all pairs between which nothing changed; those that take effects first."""
    return [*_with_effects(), *_unchanged_only()]


def known_pairs() -> list[Pair]:
    """Return the pairs between which a known weight was put on."""
    return [Pair(one, LOADED, False, PAYLOAD) for one in (LONG, SHORT)]


def repeated() -> list[tuple[Recording, Recording]]:
    """Return the pairs for repeatability: the UR10e's full motions, and the halves or runs of the other arms."""
    halved = [r.halves() for r in (PANDA, UR10, UR5, LWR4)]
    return [*combinations((LONG, SHORT, POINTS), 2), *halved, SWINGS]


def single_recordings() -> list[Recording]:
    """Return the whole logs on which known truths and the number of effects are asked for."""
    return [PANDA, UR10, LONG, SHORT, POINTS, UR5, LWR4, *SWINGS]


def _with_effects() -> Iterator[Pair]:
    halved = [r.halves() for r in (PANDA, UR10, POINTS, UR5, LWR4)]
    for two in ((LONG, SHORT), *halved, SWINGS):
        yield from (Pair(a, b) for a, b in permutations(two))


def _unchanged_only() -> Iterator[Pair]:
    """Yield pairs of which one shows what the other hides, and halves that add logs but no other arm."""
    for two in (LONG.halves(), SHORT.halves(), (LONG, POINTS), (SHORT, POINTS)):
        yield from (Pair(a, b, False) for a, b in permutations(two))
    yield from (Pair(*r.halves(), False) for r in SINGLE)
    yield from (Pair(a, b, False) for a, b in permutations(SINGLE, 2))
