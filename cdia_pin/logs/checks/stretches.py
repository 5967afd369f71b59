"""Stretches of a log that hold no measurements of their own: every signal stands still, or rows come again."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.sampling import FROZEN, longest_run
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

MOVING = 0.1  # [1], speed over the joint's largest one above which it cannot stop between two samples
FEWEST_ROWS = 20  # rows that come again; noise and rounding do not repeat so many in a row


def check_held(log: Log) -> Iterator[Finding]:
    """Report the longest stretch in which every signal stands still although the arm moved just before it.

    Args:
        log: The log.

    Yields:
        One finding, or none.
    """
    start, stop = longest_run(np.all(np.diff(_rows(log), axis=0) == 0, axis=1))
    seconds = float(log.time[stop] - log.time[start])
    if start == 0 or seconds <= FROZEN:
        return
    speed = np.abs(np.diff(log.position, axis=0)) / np.diff(log.time)[:, None]
    if stop < len(speed):
        speed[stop] = 0.0  # the jump back to where the arm is
    if (speed[start - 1] > MOVING * np.maximum(speed.max(axis=0), 1e-9)).any():
        yield Finding(
            Topic.FROZEN,
            Severity.WARNING,
            f"every signal stands still for {seconds:.3g} s from t = {log.time[start]:.4g} s, although the arm moved "
            "just before: nothing was measured there",
            advice="cut that part (Log.slice), or find out why the samples were not updated",
            value={"from_s": float(log.time[start]), "seconds": seconds},
        )


def check_copied(log: Log) -> Iterator[Finding]:
    """Report the longest stretch whose rows equal those of an earlier stretch.

    Args:
        log: The log.

    Yields:
        One finding, or none.
    """
    rows = _rows(log)
    changes = (
        np.flatnonzero(np.any(np.diff(rows, axis=0) != 0, axis=1)) + 1
    )  # an arm at rest repeats its rows
    if len(changes) <= FEWEST_ROWS:
        return
    hashes = _hashes(rows[changes])
    order = np.argsort(hashes, kind="stable")
    again = np.flatnonzero(np.diff(hashes[order]) == 0)
    shift = np.zeros(len(changes), dtype=np.intp)
    shift[order[again + 1]] = order[again + 1] - order[again]
    runs = (np.diff(shift) == 0) & (shift[1:] > 0)
    start, stop = longest_run(runs)
    if stop - start < FEWEST_ROWS:
        return
    first, last, earlier = changes[start], changes[stop], changes[start - shift[start]]
    count = int(last - first) + 1
    if not np.array_equal(rows[earlier : earlier + count], rows[first : first + count]):
        return
    yield Finding(
        Topic.COPIED,
        Severity.WARNING,
        f"{count} rows from t = {log.time[first]:.4g} s equal those from t = {log.time[earlier]:.4g} s in all signals: "
        "they were copied, or come from a simulation without noise",
        advice="leave the copied rows out: they are counted as measurements",
        value={"rows": count, "from_s": float(log.time[earlier]), "again_s": float(log.time[first])},
    )


def _rows(log: Log) -> Array:
    return np.hstack([log.position, log.effort])


def _hashes(rows: Array) -> NDArray[np.uint64]:
    """Return a number for each row; equal rows have equal numbers, and others hardly ever."""
    bits = np.ascontiguousarray(rows + 0.0).view(np.uint64)  # + 0.0: of two zeros, one sign
    odd = np.random.default_rng(0).integers(1, 2**63, rows.shape[1], dtype=np.uint64) | np.uint64(1)
    mixed = (bits ^ (bits >> np.uint64(29))) * odd
    return np.asarray((mixed ^ (mixed >> np.uint64(32))).sum(axis=1, dtype=np.uint64))
