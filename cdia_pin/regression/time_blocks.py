"""Blocks of time, of which each is left out in turn; what a motion repeats is in one block with its repeats.

Residuals of measured arms repeat with the posture. Where a motion is driven three times, a block is predicted from its
two twins, whatever the model is: nothing would be left out.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

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
    lengths = [s.distinct for s in segments]
    starts = np.cumsum([0, *lengths])
    at = np.concatenate(
        [a + np.arange(len(s.measured)) % n for a, n, s in zip(starts[:-1], lengths, segments, strict=True)]
    )
    edges = np.linspace(0, starts[-1], count + 1).astype(int)
    if len(at) == starts[-1]:
        return [slice(first + int(a), first + int(b)) for a, b in itertools.pairwise(edges)]
    block = np.searchsorted(edges, at, side="right") - 1
    return [first + np.flatnonzero(block == b) for b in range(count)]
