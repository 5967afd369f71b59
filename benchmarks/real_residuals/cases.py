"""Every case of the benchmark; a case is a name, and its name is its seed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from zlib import crc32

from benchmarks.real_residuals.draws import RECIPES, can_be_seen
from benchmarks.real_residuals.pairs import Pair, known_pairs, pairs
from benchmarks.real_residuals.variants import Variant

TUNING, REPORTING = "tuning", "reporting"  # part of each name, and so of each seed: no draw is in both
SUITES = (TUNING, REPORTING)
SIZES = (5, 10, 25)  # [%] of the joint's RMS torque
UNCHANGED, KNOWN = "unchanged", "known payload"
COMPARE, MODEL, ALONE = "compare", "model", "alone"
FLOWS = (COMPARE, MODEL, ALONE)
GONE = "gone"  # asked on request alone: the comparison with the sides exchanged, so that the effect is gone
# one case in so many: a discovery takes several times a comparison
EVERY = {COMPARE: 1, GONE: 1, MODEL: 2, ALONE: 24}
VARIED = 4  # one comparison in so many is repeated on changed logs
SAMPLE = 16  # one draw in so many
Draw = tuple[Pair, str, int]  # the logs, name of the effect, and its size [%]


@dataclass(frozen=True)
class Case:
    """A question to the program.

    Attributes:
        suite: ``tuning`` or ``reporting``.
        pair: The logs.
        effect: Name of the inserted effect, ``unchanged``, or ``known payload``.
        size: Of the inserted effect [%] of its joint's RMS torque; 0 where none is inserted.
        flow: Which question.
        variant: What is done to both logs afterwards.
    """

    suite: str
    pair: Pair
    effect: str
    size: int
    flow: str
    variant: Variant = Variant.NONE

    @property
    def draw(self) -> str:
        """Name of what is drawn, the same in each flow."""
        return f"{self.suite}/{self.pair.id}/{self.effect}" + (f" {self.size} %" if self.size else "")

    @property
    def id(self) -> str:
        """Name that stays the same."""
        return f"{self.draw}/{self.flow}" + (f"/{self.variant}" if self.variant else "")

    @property
    def plain(self) -> str:
        """Name of the same case on the logs as they are."""
        return f"{self.draw}/{self.flow}"

    @property
    def seed(self) -> int:
        """Seed of joint, sign and shape."""
        return crc32(self.draw.encode())


def planned(
    suite: str,
    arms: Iterable[str] | None = None,
    sizes: Iterable[int] = SIZES,
    flows: Iterable[str] = FLOWS,
    every: int = 1,
    among: Sequence[Pair] | None = None,
) -> list[Case]:
    """Return the cases in an order that mixes them all.

    Args:
        suite: ``tuning`` or ``reporting``.
        arms: Names of arms; all if None.
        sizes: Of inserted effects [%].
        flows: Questions.
        every: One draw in so many, each in all its flows.
        among: Pairs of logs, without a known payload; those of the measured arms if None.
    """
    chosen = None if arms is None else set(arms)
    given = _draws(sizes, pairs() if among is None else among, known_pairs() if among is None else ())
    cases = [c for c in _cases(suite, given, tuple(flows)) if chosen is None or c.pair.arm in chosen]
    mixed = sorted(cases, key=lambda c: (c.seed, c.id))
    draws = set([*dict.fromkeys(c.draw for c in mixed)][::every])
    return [c for c in mixed if c.draw in draws]


def _draws(sizes: Iterable[int], among: Iterable[Pair], known: Iterable[Pair]) -> Iterator[Draw]:
    for pair in among:
        yield pair, UNCHANGED, 0
        for effect in RECIPES if pair.takes_effects else ():
            if can_be_seen(effect, pair.arm):
                yield from ((pair, effect, size) for size in sizes)
    yield from ((pair, KNOWN, 0) for pair in known)


def _cases(suite: str, draws: Iterable[Draw], flows: tuple[str, ...]) -> Iterator[Case]:
    for pair, effect, size in draws:
        for flow in flows:
            case = Case(suite, pair, effect, size, flow)
            if not _is_asked(case):
                continue
            yield case
            if flow == COMPARE and size in {0, max(SIZES)} and case.seed % VARIED == 0:
                yield from (Case(suite, pair, effect, size, flow, v) for v in Variant if v)


def _is_asked(case: Case) -> bool:
    """Tell whether a flow is asked of a draw: of all without effect, and of a part of those with one."""
    if case.flow == ALONE:
        return case.size > min(SIZES) and case.seed % EVERY[ALONE] == 0
    return case.size == 0 or case.seed % EVERY[case.flow] == 0
