"""Blocks of time, of which each is left out in turn; what a motion repeats is in one block with its repeats.

Residuals of measured arms repeat with the posture. Where a motion is driven three times, in one log or in three, a
block is predicted from its two twins, whatever the model is: nothing would be left out.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.regression.segment import Segment

Block = slice | NDArray[np.intp]


def time_blocks(segments: Sequence[Segment], count: int, first: int = 0) -> list[Block]:
    """Cut logs into blocks of equal length, each with all its repeats.

    Args:
        segments: The logs.
        count: Number of blocks [1].
        first: Number of the compared sample with which these logs begin.

    Returns:
        Compared samples of each block: a slice if no motion repeats.
    """
    logs = _placed(segments)
    at = np.concatenate([log.start + log.places for log in logs])
    total = sum(m.distinct for m in _motions(logs))
    edges = np.linspace(0, total, count + 1).astype(int)
    if len(at) == total:
        return [slice(first + int(a), first + int(b)) for a, b in itertools.pairwise(edges)]
    block = np.searchsorted(edges, at, side="right") - 1
    return [first + np.flatnonzero(block == b) for b in range(count)]


def in_half(segments: Sequence[Segment], half: int) -> NDArray[np.bool_]:
    """Return True for the samples of one half of every log, with all their repeats, shape (K,).

    Args:
        segments: The logs.
        half: 0 for what is first in each log, 1 for the rest.
    """
    return np.concatenate([(log.places >= log.motion.distinct // 2) == half for log in _placed(segments)])


def distinct_time(segments: Sequence[Segment]) -> float:
    """Return how long the motions of logs last, each counted once and without pauses [s].

    Args:
        segments: The logs.
    """
    motions = _motions(_placed(segments))
    return sum(m.distinct / len(m.measured) * m.duration for m in motions)


def within(blocks: Sequence[Block], samples: NDArray[np.bool_]) -> list[Block]:
    """Return what some samples hold of each block, without the blocks of which they hold nothing.

    Args:
        blocks: The blocks.
        samples: True for the samples, shape (K,).
    """
    out: list[Block] = []
    for block in blocks:
        kept = samples[block]
        if kept.all():
            out.append(block)
        elif kept.any():
            out.append(np.arange(len(samples))[block][kept])
    return out


@dataclass(frozen=True)
class _Placed:
    """A log, and where its samples are in the motion that it drives.

    Attributes:
        motion: The first log of that motion.
        start: Number of distinct samples of the motions before.
        places: Place of each sample in the motion, the same for those that repeat each other, shape (K,).
    """

    motion: Segment
    start: int
    places: NDArray[np.intp]


def _placed(segments: Sequence[Segment]) -> list[_Placed]:
    out: list[_Placed] = []
    firsts: list[tuple[Segment, int]] = []  # the first log of each motion, and its start
    total = 0
    for log in segments:
        known = ((m, start, lag) for m, start in firsts if (lag := log.lag_behind(m)) is not None)
        same = next(known, None)
        if same is None:
            motion, start, places = log, total, np.arange(len(log.measured))
            firsts.append((log, total))
            total += log.distinct
        else:
            motion, start, lag = same
            nearest = np.rint((log.since + lag) / motion.pace).astype(int)
            places = np.clip(nearest, 0, len(motion.measured) - 1)
        out.append(_Placed(motion, start, places % motion.distinct))
    return out


def _motions(logs: Sequence[_Placed]) -> list[Segment]:
    """Return the first log of each motion."""
    return list({id(log.motion): log.motion for log in logs}.values())
