"""Stretches of a log that hold no measurements of their own: signals stand still, or rows come again."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.sampling import longest_run
from cdia_pin.logs.held_stretch import HeldStretch, changes_of, columns_of
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

BLOCK = 2**16  # [rows], of which hashes are computed at once
FEWEST_ROWS = 20  # rows that come again; noise and rounding do not repeat so many in a row


def check_held(log: Log, held: HeldStretch | None) -> Iterator[Finding]:
    """Report the stretch in which every signal stands still although the arm moved just before it.

    Args:
        log: The log.
        held: The stretch; None for nearly every log.

    Yields:
        One finding, or none.
    """
    if held is not None:
        begin, seconds = held.time_in(log)
        yield Finding(
            Topic.FROZEN,
            Severity.WARNING,
            f"every signal stands still for {seconds:.3g} s from t = {begin:.4g} s, although the arm moved just "
            "before: nothing was measured there",
            advice="nothing needs to be done: the end is left out of all that is computed"
            if held.is_end_of(log)
            else "leave that part out of the file, or find out why the samples were not updated",
            value={"from_s": begin, "seconds": seconds},
        )


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
    if any(not np.array_equal(x[before], x[after]) for x in columns_of(log)):
        return
    yield Finding(
        Topic.COPIED,
        Severity.WARNING,
        f"{count} rows from t = {log.time[first]:.4g} s equal those from t = {log.time[earlier]:.4g} s in all signals: "
        "they were copied, or come from a simulation without noise",
        advice="leave the copied rows out: they are counted as measurements",
        value={"rows": count, "from_s": float(log.time[earlier]), "again_s": float(log.time[first])},
    )


def _hashes(log: Log) -> NDArray[np.uint64]:
    """Return a number for each row; equal rows have equal numbers, and others hardly ever."""
    columns = columns_of(log)
    odd = np.random.default_rng(0).integers(1, 2**63, len(columns), dtype=np.uint64) | np.uint64(1)
    out = np.zeros(len(log.time), dtype=np.uint64)
    for first in range(0, len(out), BLOCK):
        block = np.s_[first : first + BLOCK]
        for column, factor in zip(columns, odd, strict=True):
            bits = (column[block] + 0.0).view(np.uint64)  # + 0.0: of two zeros, one sign
            mixed = (bits ^ (bits >> np.uint64(29))) * factor
            out[block] += mixed ^ (mixed >> np.uint64(32))
    return out
