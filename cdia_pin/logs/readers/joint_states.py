"""Serialised sensor_msgs/JointState messages as arrays: messages of one layout are read at once.

A message is a header (stamp, frame), the names of the joints and three arrays of doubles, in CDR. All messages of one
publisher have the same bytes apart from the stamp and the doubles, so one message tells where the numbers of all others
stand.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ENCAPSULATION = 4  # [B], before the body of a message, from which alignment counts
BIG_ENDIAN, LITTLE_ENDIAN = 0, 1  # second byte of the encapsulation, of plain CDR
STAMP = slice(ENCAPSULATION, ENCAPSULATION + 8)  # seconds and nanoseconds
DOUBLE = 8  # [B]
# A publisher has one or two. Where joints are listed in a new order each time, more of them cost more than messages
# that are read one by one.
MOST_LAYOUTS = 32  # layouts that are compared with all messages [1]


@dataclass(frozen=True)
class JointStates:
    """Messages that list the same joints in the same order.

    Attributes:
        names: Names of the joints, n of them.
        index: Place of each message in the topic, shape (N,).
        stamp: Time in the header of each message [ns], shape (N,).
        position: Positions, shape (N, n), or (N, 0) if the messages hold none.
        velocity: Velocities, likewise.
        effort: Efforts, likewise.
    """

    names: tuple[str, ...]
    index: NDArray[np.intp]
    stamp: NDArray[np.int64]
    position: Array
    velocity: Array
    effort: Array


@dataclass(frozen=True)
class _Layout:
    """Where the parts of a message stand: first byte and number of doubles of each array."""

    order: str  # of the bytes, as struct and NumPy write it
    names: tuple[str, ...]
    arrays: tuple[tuple[int, int], ...]
    size: int

    def same(self, rows: NDArray[np.uint8]) -> NDArray[np.bool_]:
        """Return which messages of this size have this layout and these names, as the first one has."""
        numbers = [(start, start + DOUBLE * count) for start, count in self.arrays]
        ends = [0, STAMP.start, STAMP.stop, *(at for part in numbers for at in part), self.size]
        same = np.ones(len(rows), dtype=bool)
        for start, stop in zip(ends[::2], ends[1::2], strict=True):  # what lies between the numbers
            same &= (rows[:, start:stop] == rows[0, start:stop]).all(axis=1)
        return same


def joint_states(messages: Sequence[bytes]) -> list[JointStates]:
    """Read messages, in as few blocks as there are different lists of joints.

    Args:
        messages: Serialised messages of one topic, in any order.

    Returns:
        The messages by their lists of joints.

    Raises:
        ValueError: If a message is not a JointState in plain CDR.
    """
    found: dict[tuple[object, ...], list[JointStates]] = {}
    for block in _blocks(messages):
        kind = (block.names, *(s.shape[1] for s in (block.position, block.velocity, block.effort)))
        found.setdefault(kind, []).append(block)
    return [_joined(blocks) for blocks in found.values()]


def _blocks(messages: Sequence[bytes]) -> Iterator[JointStates]:
    sizes = np.fromiter(map(len, messages), np.int64, len(messages))
    for size in np.unique(sizes):
        left = np.flatnonzero(sizes == size)
        rows = np.frombuffer(b"".join(messages[k] for k in left.tolist()), dtype=np.uint8).reshape(
            len(left), size
        )
        for _ in range(MOST_LAYOUTS):
            layout = _layout(rows[0].tobytes())
            same = layout.same(rows)
            yield _read(layout, rows[same], left[same])
            rows, left = rows[~same], left[~same]
            if not len(left):
                break
        for k in range(len(left)):
            yield _read(_layout(rows[k].tobytes()), rows[k : k + 1], left[k : k + 1])


def _read(layout: _Layout, rows: NDArray[np.uint8], index: NDArray[np.intp]) -> JointStates:
    sec = _numbers(rows, STAMP.start, 1, f"{layout.order}i4")[:, 0].astype(np.int64)
    nanosec = _numbers(rows, STAMP.start + 4, 1, f"{layout.order}u4")[:, 0].astype(np.int64)
    signals = (
        _numbers(rows, start, count, f"{layout.order}f8").astype(np.float64) for start, count in layout.arrays
    )
    return JointStates(layout.names, index, sec * 10**9 + nanosec, *signals)


def _numbers(rows: NDArray[np.uint8], start: int, count: int, kind: str) -> NDArray[np.generic]:
    size = np.dtype(kind).itemsize * count
    return np.ascontiguousarray(rows[:, start : start + size]).view(kind).reshape(len(rows), count)


def _layout(message: bytes) -> _Layout:
    """Follow the fields of one message; alignment counts from the end of the encapsulation."""
    if len(message) < STAMP.stop or message[0] or message[1] not in {BIG_ENDIAN, LITTLE_ENDIAN}:
        raise ValueError("a JointState message is not in plain CDR")
    order = "<" if message[1] == LITTLE_ENDIAN else ">"
    at = STAMP.stop

    def count() -> int:
        nonlocal at
        at += -(at - ENCAPSULATION) % 4
        (value,) = struct.unpack_from(f"{order}I", message, at)
        at += 4
        if value > len(message):
            raise ValueError("a JointState message is cut off")
        return int(value)

    def text() -> str:
        nonlocal at
        size = count()
        at += size
        return message[at - size : at].rstrip(b"\0").decode()

    try:
        text()  # frame_id
        names = tuple(text() for _ in range(count()))
        arrays = []
        for _ in ("position", "velocity", "effort"):
            size = count()
            at += -(at - ENCAPSULATION) % DOUBLE if size else 0
            arrays.append((at, size))
            at += DOUBLE * size
    except struct.error:
        raise ValueError("a JointState message is cut off") from None
    if at > len(message):
        raise ValueError("a JointState message is cut off")
    return _Layout(order, names, tuple(arrays), len(message))


def _joined(blocks: Sequence[JointStates]) -> JointStates:
    if len(blocks) == 1:
        return blocks[0]
    signals = ("index", "stamp", "position", "velocity", "effort")
    index, stamp, position, velocity, effort = (
        np.concatenate([getattr(b, signal) for b in blocks]) for signal in signals
    )
    return JointStates(blocks[0].names, index, stamp, position, velocity, effort)
