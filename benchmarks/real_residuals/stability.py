"""How stable the answers on untouched logs are, how short, and how well they predict."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from benchmarks.claims import Figure, at_least, at_most, counted
from benchmarks.markdown import Row
from benchmarks.real_residuals.bases import Base
from benchmarks.real_residuals.claims import DISCOVER_SECONDS, HELD, SAME
from benchmarks.real_residuals.judging import row
from benchmarks.real_residuals.repeats import Repeat
from cdia_pin.viewers.words import number, percent

MOST_LINES = 6  # established and likely effects, or groups of them, of one arm
ALIKE = 0.9  # intersection over union of established names
WORSE = 1.1  # [1], held-out error over what it was
BEFORE = {  # held-out error over that of the URDF, as docs/results.md had it before this benchmark
    "panda/exciting": 0.085,
    "ur10/exciting": 0.071,
    "ur10e/fourier_40s": 0.065,
    "ur10e/point_to_point": 0.064,
}


def stability(bases: Mapping[str, Base], repeats: Sequence[Repeat]) -> Iterator[Row]:
    """Yield the rows about untouched logs.

    Args:
        bases: What was found in them, by name.
        repeats: How far two logs of one arm agree.
    """
    whole = [b for b in bases.values() if b.whole and not b.failure]
    varied = [b for b in bases.values() if b.plain in bases and b.plain != b.id]
    if varied:
        same = counted([labels(b) == labels(bases[b.plain]) for b in varied])
        yield row("`discover` names the same on a log recorded otherwise", "≥ 95 %", same, at_least(SAME))
    if repeats:
        yield from _of_repeats(repeats)
    if whole:
        yield from _of_arms(whole)


def labels(base: Base) -> frozenset[str]:
    """Return what was named; that it failed where it did."""
    return frozenset([base.failure] if base.failure else (n.label for n in base.named))


def lines(base: Base) -> int:
    """Return the lines that a reader sees: groups, and effects without one."""
    return len({n.group or n.label for n in base.named})


def _of_repeats(repeats: Sequence[Repeat]) -> Iterator[Row]:
    worst, mean = min(repeats, key=lambda r: r.alike), sum(r.alike for r in repeats) / len(repeats)
    yield row(
        "established names of two logs of one arm alike, intersection over union, mean",
        f"≥ {ALIKE}",
        Figure(mean, len(repeats), f"{mean:.2f}; least {worst.alike:.2f} ({worst.id})"),
        at_least(ALIKE),
    )
    within, compared = sum(r.within for r in repeats), sum(r.compared for r in repeats)
    if compared:
        share = within / compared
        figure = Figure(share, compared, f"{percent(share)} ({within}/{compared})")
        yield row("their parameters agree within both intervals", f"≥ {HELD:.0%}", figure, at_least(HELD))


def _of_arms(whole: Sequence[Base]) -> Iterator[Row]:
    longest = max(whole, key=lines)
    yield row(
        "lines of established and likely effects, the longest answer",
        f"≤ {MOST_LINES}",
        Figure(lines(longest), len(whole), f"{lines(longest)} ({longest.id})"),
        at_most(MOST_LINES),
    )
    ratios = {b.id: b.heldout / BEFORE[b.id] for b in whole if b.id in BEFORE}
    if ratios:
        worst = max(ratios, key=ratios.__getitem__)
        yield row(
            "held-out error over that of docs/results.md before, the largest",
            f"≤ {WORSE:g}",
            Figure(ratios[worst], len(ratios), f"{number(ratios[worst], 3)} ({worst})"),
            at_most(WORSE),
        )
    slow = max(whole, key=lambda b: b.seconds)
    yield row(
        "`discover` of a whole log, processor time, the slowest",
        f"≤ {DISCOVER_SECONDS:g} s",
        Figure(slow.seconds, len(whole), f"{slow.seconds:.1f} s ({slow.id})"),
        at_most(DISCOVER_SECONDS),
    )
