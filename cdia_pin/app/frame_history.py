"""`FrameHistory`: the last frames of an arm that moves, for pages that come at any time."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import cast

from cdia_pin.viewers.scene import Frame

KEPT = 400  # frames that a page gets which comes later: the 20 s of its chart


class FrameHistory:
    """The last frames, added by one thread and read by others."""

    def __init__(self) -> None:
        self._rows: tuple[tuple[int, Frame], ...] = ()  # each with its number; replaced, never changed

    def add(self, frame: Frame) -> None:
        """Add a frame, and drop the oldest where there are too many.

        Args:
            frame: Of one moment.
        """
        rows = self._rows
        number = rows[-1][0] + 1 if rows else 0
        if len(rows) == KEPT:
            (_, gone), (second, oldest), *rest = rows
            # What is attached stands in the frame in which it changed.
            rows = ((second, oldest if "attached" in oldest else _attached(gone) | oldest), *rest)
        self._rows = (*rows, (number, frame))

    def reader(self) -> Callable[[], Frame]:
        """Return what gives, as a piece of a timeline, the frames that came since its last call; at first, all."""
        seen = -1

        def new() -> Frame:
            nonlocal seen
            rows = [(number, frame) for number, frame in self._rows if number > seen]
            if rows:
                seen = rows[-1][0]
            return _joined(frame for _, frame in rows)

        return new


def _attached(frame: Frame) -> Frame:
    return {"attached": frame["attached"]} if "attached" in frame else {}


def _joined(frames: Iterable[Frame]) -> Frame:
    piece: dict[str, list[object]] = {}
    for frame in frames:
        for key, rows in frame.items():
            piece.setdefault(key, []).extend(cast("list[object]", rows))
    return cast("Frame", piece)
