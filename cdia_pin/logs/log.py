"""A log: measured signals of an arm, joints in the robot's order, SI units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.effort_origin import EffortOrigin
from cdia_pin.logs.torque_side import TorqueSide
from cdia_pin.phrases import counted, shortened

Array = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Log:
    """Measured signals of an arm.

    Attributes:
        joints: Joint names, in the order of the columns (n of them).
        time: Time of each sample [s], strictly increasing, shape (N,).
        position: Joint positions [rad or m], shape (N, n).
        effort: Joint torques or forces [N·m or N], shape (N, n).
        velocity: Joint velocities [rad/s or m/s], shape (N, n); None if they were not recorded.
        source: Name of the file or simulation, for messages and records.
        sha256: Hash of the file's bytes; empty for a log made in memory.
        notes: Inferences and conversions of the reader, one sentence each.
        condition: Condition that this log shares with others, such as ``warm``; empty if it shares none.
        temperature: Temperature of each joint [°C], shape (N, n); None if it was not recorded.
        torque_side: Side of the gear on which the torque was measured, as far as it is known.
        side_of_format: Whether the format alone says so: a torque that shows much friction decides otherwise.
        effort_origin: Whether the efforts were measured, were without gravity, or were commanded.
        effort_tolerance: Tolerance of the scale of each joint's torque, 95 % [1], shape (n,); None if nobody states it.
        recorded: When the log began [s since 1970]; None where its clock does not say it.
    """

    joints: tuple[str, ...]
    time: Array
    position: Array
    effort: Array
    velocity: Array | None = None
    source: str = "memory"
    sha256: str = ""
    notes: tuple[str, ...] = ()
    condition: str = ""
    temperature: Array | None = None
    torque_side: TorqueSide = TorqueSide.UNKNOWN
    side_of_format: bool = False
    effort_origin: EffortOrigin = EffortOrigin.MEASURED
    effort_tolerance: Array | None = None
    recorded: float | None = None

    def __post_init__(self) -> None:
        n, count = len(self.joints), len(self.time)
        if count < 2:
            raise LogError(f"{self.source}: a log needs at least 2 samples, found {count}")
        signals = {"position": self.position, "effort": self.effort}
        if self.velocity is not None:
            signals["velocity"] = self.velocity
        if self.temperature is not None:
            signals["temperature"] = self.temperature
        for name, signal in signals.items():
            if signal.shape != (count, n):
                raise LogError(
                    f"{self.source}: {name} has shape {signal.shape}, expected ({count}, {n}) "
                    f"for {count} times and {n} joints"
                )
            bad = ~np.isfinite(signal)
            if bad.any():
                row, column = np.argwhere(bad)[0]
                raise LogError(
                    f"{self.source}: {name}.{self.joints[column]} holds {counted(int(bad.sum()), 'value')} not finite, "
                    f"the first in sample {row} (t = {self.time[row]:g} s); remove or repair those rows"
                )
        if not np.isfinite(self.time).all():
            raise LogError(f"{self.source}: time holds values that are not finite")
        step = np.diff(self.time)
        if (step <= 0).any():
            row = int(np.argmax(step <= 0)) + 1
            raise LogError(
                f"{self.source}: time must increase, but sample {row} (t = {self.time[row]:g} s) does not "
                f"come after the one before it (t = {self.time[row - 1]:g} s)"
            )

    def __repr__(self) -> str:
        size = f"{len(self.joints)} joints, {len(self.time)} samples, {self.duration:.4g} s at {self.rate:.4g} Hz"
        return f"Log({shortened(self.source)}, {size})"

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def rate(self) -> float:
        """Median sampling rate [Hz]."""
        return float(1.0 / np.median(np.diff(self.time)))

    def slice(self, start: int, stop: int) -> Log:
        """Return a part of the log.

        Args:
            start: Index of the first sample.
            stop: Index after the last sample.

        Returns:
            The samples start to stop − 1, with their times.
        """
        part = np.s_[start:stop]
        return replace(
            self,
            time=self.time[part],
            position=self.position[part],
            effort=self.effort[part],
            velocity=None if self.velocity is None else self.velocity[part],
            temperature=None if self.temperature is None else self.temperature[part],
        )

    def noted(self, *notes: str) -> Log:
        """Return the log with more notes.

        Args:
            notes: Sentences that are added.

        Returns:
            A new log; this one is not changed.
        """
        return replace(self, notes=(*self.notes, *notes))


def listed(logs: Log | Sequence[Log] | None) -> list[Log]:
    """Return one log, several or none as a list.

    Args:
        logs: A log, logs, or None.

    Returns:
        A new list.
    """
    return [] if logs is None else [logs] if isinstance(logs, Log) else list(logs)
