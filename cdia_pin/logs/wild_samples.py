"""Wild samples: values that leave a signal and come back faster than any motion.

A value is wild if both neighbours of its run lie on the same side of it, far away. A moving joint leaves and comes back
only at a reversal, where its acceleration bounds the distance: a T² / 2 within ± T. Noise and the steps of an encoder
leave and come back too, so they bound the distance as well. `held_values` finds longer runs, of one wrong position.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.derivatives import akima, linear
from cdia_pin.logs.held_values import held_runs
from cdia_pin.logs.log import Log
from cdia_pin.phrases import counted

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

FASTEST = 1000.0  # [rad/s² or m/s²], fifty times what arms do; the joints of measured logs show up to 190 by rounding
TOP_SPEED = 30.0  # [rad/s or m/s], which no arm reaches; beside a gap the acceleration bounds nothing
COARSEST = 0.02  # [rad or m], a smaller excursion may be a step of the encoder, and is lost in the filter
POSITION_NOISE = 30.0  # [1], excursion over the first quartile of the second differences: 10 σ of white noise
OTHER_NOISE = 20.0  # [1], the same over their 90th percentile; measured efforts show up to 11
EFFORT_SPANS = (
    3.0  # [1], excursion over the range of the other efforts; an impact stays below 0.6 in measured logs
)
ABSURD_SPANS = (
    100.0  # [1], excursion over the range of the middle three fifths of the efforts, whatever the others are
)
LONGEST = 4  # [samples] of a run; what lasts longer is no single sample
# What a driver writes when a bus fails is a row of zeros, and some joints may be near that. Of eleven such rows of a
# measured log 0.3 and 0.5 find all, and 0.9 finds nine.
FAILED = 0.5  # share of the joints [1], two at least, with a wild position, from which on nothing in a row was measured
END = 10.0  # [1], first or last step over the largest usual one: at an end there is one neighbour only
USUAL = 99.5  # [%], of the steps are usual: a signal that is held for 0.1 s at 1 kHz changes in 1 %
LARGEST_SHARE = 0.01  # [1], of the samples; above it something is wrong that leaving out does not mend
LARGEST_HELD = 0.1  # [1], of the samples in runs of one value: each of them is one event, as a gap is
JUDGED = 100_000  # [samples], by which noise and range are judged
NAMED = 3  # samples that a note names before it counts them


@dataclass(frozen=True)
class WildSample:
    """A value that no motion makes.

    Attributes:
        signal: ``position``, ``effort`` or ``velocity``.
        joint: Name of the joint.
        row: Index of the sample.
        time: Its time [s].
        value: The value [rad, m, N·m, N, rad/s or m/s].
        held: Whether it belongs to a long run of this one value.
    """

    signal: str
    joint: str
    row: int
    time: float
    value: float
    held: bool = False

    def __str__(self) -> str:
        return f"{self.signal} of {self.joint} {'stands at' if self.held else 'is'} {self.seen}"

    @property
    def seen(self) -> str:
        """The value, and when it came."""
        return f"{self.value:.4g} {'from' if self.held else 'at'} t = {self.time:.6g} s{' on' if self.held else ''}"


def wild_samples(log: Log, velocities: bool = False) -> tuple[WildSample, ...]:
    """Find the values of positions and efforts, and where asked velocities, that no motion makes.

    Runs of up to four positions or velocities are found, single efforts, and up to 0.5 s of one wrong position.

    Args:
        log: The log.
        velocities: Whether recorded velocities are used. What derives them from positions does not ask.

    Returns:
        The values, by signal, joint and time; empty for nearly every log.
    """
    held_at: dict[
        tuple[str, int], dict[int, bool]
    ] = {}  # by signal and joint: wild rows, and whether each is held
    for signal in ("position", "effort", *(("velocity",) if velocities and log.velocity is not None else ())):
        for k in range(len(log.joints)):
            with np.errstate(over="ignore", invalid="ignore"):
                rows, held = _WILD[signal](getattr(log, signal)[:, k], log.time)
            held_at[signal, k] = {int(row): row in held for row in {*rows, *held}}
    _add_failed_rows(held_at, len(log.joints))
    return tuple(
        WildSample(signal, log.joints[k], r, float(log.time[r]), float(getattr(log, signal)[r, k]), held)
        for (signal, k), wild in held_at.items()
        for r, held in sorted(wild.items())
    )


def _add_failed_rows(held_at: dict[tuple[str, int], dict[int, bool]], joints: int) -> None:
    """Add all positions and efforts of the rows in which the positions of many joints are wild."""
    count = Counter(row for (signal, _), wild in held_at.items() if signal == "position" for row in wild)
    held = {row for wild in held_at.values() for row, stands in wild.items() if stands}
    failed = [row for row, wild in count.items() if wild >= max(2.0, FAILED * joints)]
    for (signal, _), wild in held_at.items():
        for row in failed if signal != "velocity" else ():
            wild.setdefault(row, row in held)


def failed_rows(found: Sequence[WildSample], log: Log) -> list[int]:
    """Return the rows in which all positions and efforts are wild, as a bus that fails leaves them.

    Args:
        found: Its wild samples.
        log: The log.
    """
    if len(log.joints) < 2:
        return []
    count = Counter(s.row for s in found if s.signal != "velocity")
    return sorted(row for row, wild in count.items() if wild == 2 * len(log.joints))


def share_of(found: Sequence[WildSample], log: Log) -> float:
    """Return the share of the samples in which a joint has a wild value [1].

    Args:
        found: Its wild samples.
        log: The log.
    """
    return len({s.row for s in found}) / len(log.time)


def too_many(found: Sequence[WildSample], log: Log) -> bool:
    """Return whether there are so many wild samples that leaving them out does not mend a log.

    Args:
        found: Its wild samples.
        log: The log.
    """
    single = [s for s in found if not s.held]
    return share_of(single, log) > LARGEST_SHARE or share_of(found, log) > LARGEST_HELD


def beginnings(found: Sequence[WildSample]) -> list[WildSample]:
    """Return wild samples, and of each run of one value the first.

    Args:
        found: Wild samples, by signal, joint and time.
    """
    before = [None, *found[:-1]]
    return [s for s, b in zip(found, before, strict=True) if not (b and _goes_on(b, s))]


def _goes_on(before: WildSample, sample: WildSample) -> bool:
    """Return whether a sample belongs to the run of the one before."""
    same = (before.signal, before.joint, before.value) == (sample.signal, sample.joint, sample.value)
    return same and before.held and sample.held and sample.row == before.row + 1


def repaired(log: Log, found: Sequence[WildSample]) -> Log:
    """Return a log without wild values: the others are interpolated at their times, as if they were missing.

    Args:
        log: The log.
        found: Its wild samples.
    """
    changed: dict[str, Any] = {}
    for signal, between in (("position", akima), ("effort", linear), ("velocity", linear)):
        values = getattr(log, signal)
        for k, joint in enumerate(log.joints):
            rows = [s.row for s in found if (s.signal, s.joint) == (signal, joint)]
            if not rows:
                continue
            values = changed.setdefault(signal, values.copy())
            kept = np.ones(len(log.time), dtype=bool)
            kept[rows] = False
            inside = np.clip(log.time[rows], *log.time[kept][[0, -1]])
            values[rows, k] = between(inside, log.time[kept], values[kept, k : k + 1])[:, 0]
    return replace(log, **changed) if changed else log


def without_wild_samples(log: Log, velocities: bool = False) -> Log:
    """Return a log without its wild values, with a note that says how many there were.

    Args:
        log: The log.
        velocities: Whether recorded velocities are used.

    Returns:
        The log itself if it has none.

    Raises:
        LogError: If they are more than 1 % of the samples, or 10 % with runs of one value.
    """
    found = wild_samples(log, velocities)
    if not found:
        return log
    if too_many(found, log):
        raise LogError(f"{log.source}: {said_of(found, log)}; find out what went wrong when it was recorded")
    return repaired(log, found).noted(f"{said_of(found, log)}; left out of all that is computed")


def said_of(found: Sequence[WildSample], log: Log) -> str:
    """Return what is said of wild samples: how many there are, and the first of them.

    Args:
        found: Wild samples, at least one.
        log: Their log.
    """
    rows = len({s.row for s in found})
    share = f" ({100 * share_of(found, log):.2g} % of the samples)" if rows > 1 else ""
    said = f"{counted(rows, 'sample')} that no motion makes{share}"
    first = beginnings(found)
    more = ", …" if len(first) > NAMED else ""
    return f"{said}: {', '.join(map(str, first[:NAMED]))}{more}"


def _wild_positions(x: Array, time: Array) -> tuple[list[int], set[int]]:
    step = np.diff(x)
    if not float(np.max(np.abs(step))) > COARSEST:  # nearly always
        return [], set()
    large = max(COARSEST, POSITION_NOISE * _curvature(x, 25))
    far = []
    for first, last, distance in _excursions(x, step, large):
        before, after = max(first - 1, 0), min(last, len(x) - 1)
        half = (time[after] - time[before]) / 2
        quickest = min(time[first] - time[before] or np.inf, time[after] - time[last - 1] or np.inf)
        if distance > min(FASTEST * half**2 / 2, TOP_SPEED * quickest):
            far.append((first, last))
    short = _farthest_first(x, far)
    runs = held_runs(x, time, large, FASTEST, short)
    return short, {row for run in runs for row in range(*run)}


def _wild_velocities(x: Array, time: Array) -> tuple[list[int], set[int]]:
    """Return the rows of velocities that leave and come back faster than any acceleration: a T within ± T."""
    step = np.diff(x)
    far = [
        (first, last)
        for first, last, distance in _excursions(x, step, OTHER_NOISE * _curvature(x, 90))
        if distance > FASTEST * (time[min(last, len(x) - 1)] - time[max(first - 1, 0)]) / 2
    ]
    return _farthest_first(x, far), set()


def _wild_efforts(x: Array, _: Array) -> tuple[list[int], set[int]]:
    thin = x[:: max(1, len(x) // JUDGED)]
    span = float(np.subtract(*np.percentile(thin, [99.5, 0.5])))
    noise = OTHER_NOISE * _curvature(x, 90)
    # one value in a hundred that is wild makes noise and range as large as itself
    absurd = ABSURD_SPANS * float(np.subtract(*np.percentile(thin, [80, 20]))) or np.inf
    large = min(max(noise, 0.05 * span), absurd)  # a value lost as 0 may be near the others
    beyond = min(max(noise, EFFORT_SPANS * span), absurd)
    far = [
        (first, last)
        for first, last, distance in _excursions(x, np.diff(x), large)
        if last - first == 1 and (distance > beyond or x[first] == 0)
    ]
    return _farthest_first(x, far), set()


_WILD = {"position": _wild_positions, "effort": _wild_efforts, "velocity": _wild_velocities}


def _farthest_first(x: Array, runs: list[tuple[int, int]]) -> list[int]:
    """Return the rows of runs, without those that are far only from another, wilder run beside them."""

    def wildness(run: tuple[int, int]) -> float:
        first, last = run
        around = x[max(0, first - 2 * LONGEST) : last + 2 * LONGEST]
        return float(np.min(np.abs(x[first:last] - np.median(around))))

    wild: set[int] = set()
    for first, last in sorted(runs, key=wildness, reverse=True):
        if first - 1 not in wild and last not in wild:
            wild.update(range(first, last))
    return sorted(wild)


def _curvature(x: Array, percent: float) -> float:
    """Return a percentile of the absolute second differences [unit of x], of stretches all over a long signal."""
    every = max(1, len(x) // JUDGED)
    middle = np.arange(1, len(x) - 1, every)
    if not len(middle):
        return 0.0
    bend = np.abs(x[middle - 1] - 2 * x[middle] + x[middle + 1])
    return float(np.percentile(np.nan_to_num(bend, nan=np.inf), percent))


def _excursions(x: Array, step: Array, large: float) -> Iterator[tuple[int, int, float]]:
    """Yield first row, row after the last and distance of each short run that leaves by a large step and comes back."""
    jumps = np.flatnonzero(~(np.abs(step) <= large))
    for lag in range(1, LONGEST + 1):
        i, j = jumps[:-lag], jumps[lag:]
        back = (j - i <= LONGEST) & (np.sign(step[i]) == -np.sign(step[j]))
        for before, last in zip(i[back].tolist(), j[back].tolist(), strict=True):
            run, side = x[before + 1 : last + 1], np.sign(step[before])
            distance = float(np.min(side * (run - side * max(side * x[before], side * x[last + 1]))))
            if distance > large:
                yield before + 1, last + 1, distance
    yield from _at_the_ends(step, jumps)


def _at_the_ends(step: Array, jumps: Rows) -> Iterator[tuple[int, int, float]]:
    if not len(jumps):
        return
    usual = END * float(np.percentile(np.abs(step), USUAL))
    count = len(step) + 1
    for k, first, last in ((jumps[0], 0, int(jumps[0]) + 1), (jumps[-1], int(jumps[-1]) + 1, count)):
        if last - first <= LONGEST and not abs(step[k]) <= usual:
            yield first, last, float(abs(step[k]))
