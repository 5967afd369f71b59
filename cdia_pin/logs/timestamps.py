"""Conversion of logged times to seconds."""

from __future__ import annotations

from bisect import bisect_right
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError, unknown_name
from cdia_pin.phrases import counted

Array = NDArray[np.float64]

SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}  # [s] in one of each unit
EPOCH = 1e8  # [s], three years; a log that starts later counts from 1970 and not from its own start

MOST_MISPLACED = 0.01  # rows over all rows [1] out of order; of more, two logs may be in one file
# [%] of the times, which so few rows do not reach: no good one is farther from this part than its length.
MIDDLE = (2.0, 98.0)

# Median step between samples below which times without a unit are taken as s, ms, µs. Robot logs have 5 Hz to
# 5 kHz, so the ranges of the steps in these units do not overlap.
_LARGEST_STEP = (("s", 0.5), ("ms", 200.0), ("us", 2e5))
_EPOCH_NOW = (1.2e9, 2.6e9)  # [s]: years 2008 to 2052


def in_seconds(raw: NDArray[Any], unit: str | None, source: str) -> tuple[Array, list[str]]:
    """Convert times to seconds.

    Args:
        raw: Times as read, integer or float, shape (N,).
        unit: ``s``, ``ms``, ``us`` or ``ns``; inferred from the median step if None.
        source: Name of the log, for messages.

    Returns:
        Times [s], shape (N,), and a note for each inference and change.

    Raises:
        LogError: If the unit is unknown or a time is not finite.
    """
    notes = []
    if raw.dtype.kind == "f" and not np.isfinite(raw).all():
        row = int(np.argmax(~np.isfinite(raw)))
        raise LogError(f"{source}: time is empty or not finite in sample {row}; remove or repair that row")
    if unit is None:
        unit = _likely_unit(raw)
        if unit != "s":
            notes.append(
                f"times taken as {unit}, because their median step is {_median_step(raw):g}; "
                "--convert time=s changes it"
            )
    elif unit not in SECONDS:
        raise LogError(f"{source}: " + unknown_name("unit of time", unit, SECONDS))
    scale = SECONDS[unit]
    if len(raw) and abs(float(raw[0])) * scale > EPOCH:
        # The start is subtracted before the conversion: integer nanoseconds since 1970 do not fit a double.
        notes.append(
            f"time counts from the first sample, which was at {float(raw[0]) * scale:.6f} s since 1970"
        )
        raw = raw - raw[0]
    per_second = round(1.0 / scale)
    return np.asarray(raw, dtype=np.float64) / per_second, notes


def in_order(raw: NDArray[Any]) -> tuple[NDArray[np.bool_], list[str]]:
    """Find the rows whose times are in order: a damaged packet has another one.

    Args:
        raw: Times as read, integer or float, shape (N,).

    Returns:
        A mask of the rows to keep, shape (N,), and a note if some are left out. All are kept if the times are in order,
        or if too many are not.
    """
    every = np.ones(len(raw), dtype=bool)
    if not (np.diff(raw) < 0).any() or not np.isfinite(raw).all():
        return every, []
    low, high = np.percentile(raw, MIDDLE)
    kept = (raw >= 2 * low - high) & (raw <= 2 * high - low)
    kept[kept] = _longest_in_order(raw[kept])
    left = np.flatnonzero(~kept)
    if len(left) > MOST_MISPLACED * len(raw):
        return every, []
    said = f"{counted(len(left), 'row')} left out, the first one sample {left[0]}, because"
    return kept, [f"{said} a time of {raw[left[0]]:g} does not follow those around it"]


def _longest_in_order(raw: NDArray[Any]) -> NDArray[np.bool_]:
    """Return a mask of the longest sequence of rows whose times do not fall, shape (N,)."""
    lowest: list[float] = []  # last time of the sequences of each length, the lowest that there is
    last: list[int] = []  # their last rows
    before = np.full(len(raw), -1)
    for row, time in enumerate(raw.tolist()):
        at = bisect_right(lowest, time)
        before[row] = last[at - 1] if at else -1
        lowest[at : at + 1], last[at : at + 1] = [time], [row]
    kept = np.zeros(len(raw), dtype=bool)
    row = last[-1]
    while row >= 0:
        kept[row] = True
        row = int(before[row])
    return kept


def recorded_at(raw: NDArray[Any], unit: str | None, source: str) -> float | None:
    """Return when a log began, where its times count from 1970.

    Args:
        raw: Times as read, integer or float, shape (N,).
        unit: ``s``, ``ms``, ``us`` or ``ns``; inferred from the median step if None.
        source: Name of the log, for messages.

    Returns:
        Time of the first sample [s since 1970]; None where the log's clock has a start of its own.

    Raises:
        LogError: If the unit is unknown.
    """
    unit = unit or _likely_unit(raw)
    if unit not in SECONDS:
        raise LogError(f"{source}: " + unknown_name("unit of time", unit, SECONDS))
    began = float(raw[0]) * SECONDS[unit] if len(raw) else 0.0
    return began if _EPOCH_NOW[0] < began < _EPOCH_NOW[1] else None


def _median_step(raw: NDArray[Any]) -> float:
    return float(np.median(np.diff(raw))) if len(raw) > 1 else 0.0


def _likely_unit(raw: NDArray[Any]) -> str:
    step = _median_step(raw)
    if len(raw) and _EPOCH_NOW[0] < float(raw[0]) < _EPOCH_NOW[1] and step < 20.0:
        return "s"
    return next((unit for unit, largest in _LARGEST_STEP if step < largest), "ns")
