"""Stretches of a log that hold no measurements of their own: signals stand still, or rows come again."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.sampling import FROZEN, longest_run
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

MOVING = 0.1  # [1], speed over the joint's largest one above which it cannot stop between two samples
BLOCK = 2**16  # [rows], of which hashes are computed at once
FEWEST_ROWS = 20  # rows that come again; noise and rounding do not repeat so many in a row


@dataclass(frozen=True)
class HeldStretch:
    """A stretch in which every signal stands still although the arm moved just before it.

    Attributes:
        start: Index of its first sample.
        stop: Index of its last sample.
    """

    start: int
    stop: int

    def finding(self, log: Log) -> Finding:
        """Return what is said of it.

        Args:
            log: The log.
        """
        begin, end = float(log.time[self.start]), float(log.time[self.stop])
        return Finding(
            Topic.FROZEN,
            Severity.WARNING,
            f"every signal stands still for {end - begin:.3g} s from t = {begin:.4g} s, although the arm moved just "
            "before: nothing was measured there",
            advice="leave that part out of the file, or find out why the samples were not updated",
            value={"from_s": begin, "seconds": end - begin},
        )

    def left_out_of(self, log: Log) -> Log:
        """Return the longer of the parts before and after it.

        Args:
            log: The log.
        """
        rows = len(log.time)
        return log.slice(0, self.start) if self.start > rows - self.stop else log.slice(self.stop + 1, rows)


def held_stretch(log: Log) -> HeldStretch | None:
    """Find the longest stretch in which every signal stands still although the arm moved just before it.

    Args:
        log: The log.
    """
    start, stop = longest_run(~changes_of(log))
    if start == 0 or log.time[stop] - log.time[start] <= FROZEN:
        return None
    speed = np.abs(np.diff(log.position, axis=0)) / np.diff(log.time)[:, None]
    if stop < len(speed):
        speed[stop] = 0.0  # the jump back to where the arm is
    # the middle of three, because two samples with nearly the same time stamp make any speed
    fastest = np.median([speed[:-2], speed[1:-1], speed[2:]], axis=0).max(axis=0) if len(speed) > 2 else 0.0
    moved = (speed[start - 1] > MOVING * np.maximum(fastest, 1e-9)).any()
    return HeldStretch(start, stop) if moved else None


def check_copied(log: Log) -> Iterator[Finding]:
    """Report the longest stretch whose rows equal those of an earlier stretch.

    Args:
        log: The log.

    Yields:
        One finding, or none.
    """
    changes = np.flatnonzero(changes_of(log)) + 1  # an arm at rest repeats its rows
    if len(changes) <= FEWEST_ROWS:
        return
    hashes = _hashes(log)[changes]
    order = np.argsort(hashes, kind="stable")
    hashes = hashes[order]
    again = np.flatnonzero(hashes[1:] == hashes[:-1])
    del hashes
    shift = np.zeros(len(changes), dtype=np.intp)
    shift[order[again + 1]] = order[again + 1] - order[again]
    runs = (np.diff(shift) == 0) & (shift[1:] > 0)
    start, stop = longest_run(runs)
    if stop - start < FEWEST_ROWS:
        return
    first, last, earlier = changes[start], changes[stop], changes[start - shift[start]]
    count = int(last - first) + 1
    before, after = np.s_[earlier : earlier + count], np.s_[first : first + count]
    if any(not np.array_equal(x[before], x[after]) for x in _columns(log)):
        return
    yield Finding(
        Topic.COPIED,
        Severity.WARNING,
        f"{count} rows from t = {log.time[first]:.4g} s equal those from t = {log.time[earlier]:.4g} s in all signals: "
        "they were copied, or come from a simulation without noise",
        advice="leave the copied rows out: they are counted as measurements",
        value={"rows": count, "from_s": float(log.time[earlier]), "again_s": float(log.time[first])},
    )


def _columns(log: Log) -> list[Array]:
    return [*log.position.T, *log.effort.T]


def changes_of(log: Log) -> NDArray[np.bool_]:
    """Tell for each sample but the first whether any signal differs from the sample before.

    Args:
        log: The log, N samples.

    Returns:
        Flags, shape (N − 1,).
    """
    changes = np.zeros(len(log.time) - 1, dtype=bool)
    for column in _columns(log):
        changes |= column[1:] != column[:-1]
    return changes


def _hashes(log: Log) -> NDArray[np.uint64]:
    """Return a number for each row; equal rows have equal numbers, and others hardly ever."""
    columns = _columns(log)
    odd = np.random.default_rng(0).integers(1, 2**63, len(columns), dtype=np.uint64) | np.uint64(1)
    out = np.zeros(len(log.time), dtype=np.uint64)
    for first in range(0, len(out), BLOCK):
        block = np.s_[first : first + BLOCK]
        for column, factor in zip(columns, odd, strict=True):
            bits = (column[block] + 0.0).view(np.uint64)  # + 0.0: of two zeros, one sign
            mixed = (bits ^ (bits >> np.uint64(29))) * factor
            out[block] += mixed ^ (mixed >> np.uint64(32))
    return out
