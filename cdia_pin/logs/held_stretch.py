"""A stretch of a log in which nothing was measured: every signal stands still although the arm moved just before.

A recorder that stopped goes on with the last row, or fills the file with zeros.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.sampling import FROZEN, longest_run
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

LEAST_LEFT = (
    2  # samples before the stretch [1], without which nothing tells that the arm moved, and no log is left
)
MOVING = 0.1  # [1], speed over the joint's largest one above which it cannot stop between two samples


@dataclass(frozen=True)
class HeldStretch:
    """A stretch in which every signal stands still although the arm moved just before it.

    Attributes:
        start: Index of its first sample.
        stop: Index of its last sample.
    """

    start: int
    stop: int

    def time_in(self, log: Log) -> tuple[float, float]:
        """Return when it begins and how long it lasts [s].

        Args:
            log: The log.
        """
        begin, end = float(log.time[self.start]), float(log.time[self.stop])
        return begin, end - begin

    def is_end_of(self, log: Log) -> bool:
        """Return True if nothing comes after it.

        Args:
            log: The log.
        """
        return self.stop == len(log.time) - 1

    def left_out_of(self, log: Log) -> Log:
        """Return the longer of the parts before and after it.

        Args:
            log: The log.
        """
        rows = len(log.time)
        first, last = self.start, rows - self.stop - 1
        return log.slice(0, self.start) if first >= last else log.slice(self.stop + 1, rows)


def held_stretch(log: Log) -> HeldStretch | None:
    """Find the longest stretch in which every signal stands still although the arm moved just before it.

    Args:
        log: The log.
    """
    start, stop = longest_run(~changes_of(log))
    if start < LEAST_LEFT or log.time[stop] - log.time[start] <= FROZEN:
        return None
    speed = np.abs(np.diff(log.position, axis=0)) / np.diff(log.time)[:, None]
    if stop < len(speed):
        speed[stop] = 0.0  # the jump back to where the arm is
    # the middle of three, because two samples with nearly the same time stamp make any speed
    fastest = np.median([speed[:-2], speed[1:-1], speed[2:]], axis=0).max(axis=0) if len(speed) > 2 else 0.0
    moved = (speed[start - 1] > MOVING * np.maximum(fastest, 1e-9)).any()
    return HeldStretch(start, stop) if moved else None


def without_idle_end(log: Log) -> Log:
    """Return a log without the end in which nothing was measured, with a note that says so.

    Args:
        log: The log.
    """
    held = held_stretch(log)
    if held is None or not held.is_end_of(log):
        return log
    begin, seconds = held.time_in(log)
    return log.slice(0, held.start).noted(
        f"every signal stands still for the last {seconds:.3g} s, from t = {begin:.4g} s on, although the arm moved "
        "just before; left out of all that is computed"
    )


def changes_of(log: Log) -> NDArray[np.bool_]:
    """Tell for each sample but the first whether any signal differs from the sample before.

    Args:
        log: The log, N samples.

    Returns:
        Flags, shape (N − 1,).
    """
    changes = np.zeros(len(log.time) - 1, dtype=bool)
    for column in columns_of(log):
        changes |= column[1:] != column[:-1]
    return changes


def columns_of(log: Log) -> list[Array]:
    """Return the positions and efforts of each joint, shape (N,) each.

    Args:
        log: The log, N samples.
    """
    return [*log.position.T, *log.effort.T]
