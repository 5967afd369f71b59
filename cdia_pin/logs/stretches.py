"""Stretches: parts of a long log, spread evenly over it, in which effects are searched."""

from __future__ import annotations

from itertools import pairwise

COUNT = 20  # stretches of a log [1]: every phase of it is seen, and each of ten blocks of time has two


def stretches(count: int, most: int | None, multiple: int = 1) -> list[slice]:
    """Return the parts of a signal that are looked at: all of it, or stretches of equal length.

    The first one begins with the signal, the last one ends with it, and the gaps between them are equal.

    Args:
        count: Samples of the signal [1].
        most: Largest number of samples that are looked at [1]; no limit if None.
        multiple: Starts and lengths are multiples of so many samples [1].
    """
    if most is None or count <= most:
        return [slice(0, count)]
    length = max(most // COUNT // multiple, 1) * multiple
    last = (count - length) // multiple
    starts = (round(k * last / (COUNT - 1)) * multiple for k in range(COUNT))
    return [slice(start, start + length) for start in starts]


def blocks(part: slice, largest: int, multiple: int = 1) -> list[slice]:
    """Return a part of a signal as blocks that follow each other.

    Args:
        part: The part.
        largest: Usual number of samples of a block [1], at least `multiple`; the last one may have half as many more.
        multiple: Blocks begin so many samples after the beginning of the part, or a multiple of it [1].
    """
    step = largest // multiple * multiple
    starts = list(range(part.start, part.stop, step))
    if len(starts) > 1 and part.stop - starts[-1] < step // 2:
        starts.pop()  # a few samples say little by themselves: the block before takes them
    return [slice(*ends) for ends in pairwise([*starts, part.stop])]
