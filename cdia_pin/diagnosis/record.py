"""`MonitorRun`: what a monitor left behind, for tables, pages and files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.diagnosis.journal import Belief, Journal, Look
from cdia_pin.diagnosis.monitor import Monitor
from cdia_pin.diagnosis.status import Event, Stage, Status, fault_to_dict
from cdia_pin.effects import Term
from cdia_pin.logs.log import Log
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

STAGES = tuple(Stage)  # what the numbers in `MonitorRun.stages` mean
STORED = 100.0  # [Hz], ticks that are kept; an hour of seven joints is then 165 MB


@dataclass(frozen=True, eq=False)
class MonitorRun:
    """A replay or a closed loop as the monitor saw it, K ticks of n joints in the robot's order.

    Attributes:
        robot: The arm.
        time: Time of the ticks kept [s], shape (K,).
        residual: Torque that the model lacks, filtered [N·m or N], shape (K, n); of the engine ``thesis`` the
            velocity error of its observer [rad/s or m/s].
        threshold: What a healthy arm's residual stays below, same unit, shape (K, n).
        stages: Index in `STAGES` of each joint's stage, shape (K, n).
        torque_correction: What is added to the nominal torque [N·m or N], shape (K, n).
        position: Positions as measured [rad or m], shape (K, n).
        velocity: Velocities as measured [rad/s or m/s], shape (K, n); None where there are none.
        effort: Torque that acted before the tick [N·m or N], shape (K, n).
        desired: Positions asked for [rad or m], shape (K, n); None in a replay.
        events: Everything that was said, at whichever tick.
        faults: What was believed at the end.
        record: Engine, bank, settings, healthy runs, thresholds and version.
        looks: Which hypotheses lived on each joint, wherever that changed; none of the engine ``thesis``.
        beliefs: The faults believed in and their sizes, wherever they changed.
    """

    robot: RobotModel
    time: Array
    residual: Array
    threshold: Array
    stages: NDArray[np.uint8]
    torque_correction: Array
    position: Array
    velocity: Array | None
    effort: Array
    desired: Array | None
    events: tuple[Event, ...]
    faults: tuple[Term, ...]
    record: dict[str, Any]
    looks: tuple[Look, ...] = ()
    beliefs: tuple[Belief, ...] = ()

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, in the order of the columns."""
        return self.robot.joints

    @property
    def in_torque(self) -> bool:
        """Whether residuals are torques, and not velocities."""
        return self.record["engine"] != "thesis"

    def tracking_rms(self, since: float = -np.inf) -> dict[str, float]:
        """Return the RMS of position less desired position of each joint [rad or m]; empty without reference.

        Args:
            since: From when on [s].
        """
        if self.desired is None:
            return {}
        kept = self.time >= since
        error = np.sqrt(np.mean((self.position[kept] - self.desired[kept]) ** 2, axis=0))
        return dict(zip(self.joints, error.tolist(), strict=True))

    def to_dict(self) -> dict[str, Any]:
        """Return the run as files of the schema cdia-events/1 have it."""
        out: dict[str, Any] = {
            "schema": schemas.EVENTS,
            "robot": self.robot.name,
            "joints": list(self.joints),
            "events": [e.to_dict(self.robot) for e in self.events],
            "faults": [fault_to_dict(t, self.robot) for t in self.faults],
        }
        if self.desired is not None:
            out["tracking_rms"] = self.tracking_rms()
        return {**out, "record": self.record}


class Recorder:
    """Keeps what a monitor says and sees, as many ticks as are asked for and every one with an event.

    Args:
        monitor: Whose statuses are recorded.
        rate: Ticks that are kept [Hz]; all of them if the monitor is slower.
    """

    def __init__(self, monitor: Monitor, rate: float = STORED) -> None:
        self._monitor, self._period = monitor, 1.0 / rate
        self._rows = bytearray()
        self._next = -np.inf
        self._nothing = np.full(monitor.model.robot.n, np.nan)
        self._velocity, self._desired = True, True
        self._journal = Journal(monitor)

    def __call__(
        self, status: Status, q: Array, v: Array | None, tau: Array, desired: Array | None = None
    ) -> None:
        """Take note of a tick.

        Args:
            status: What the monitor said.
            q: Positions it was given [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,), or None.
            tau: Torque [N·m or N], shape (n,).
            desired: Position asked for [rad or m], shape (n,), or None.
        """
        self._journal(status)
        late = status.time - self._next  # a little below zero: not due; far below: time has gone back
        due = not -2 * self._period < late < 0
        if not due and not status.events:
            return
        if due:
            carried = (
                late if 0 < late < 0.5 * self._period else 0.0
            )  # keeps the rate where ticks do not divide it
            self._next = status.time + self._period - carried - 1e-9
        self._velocity, self._desired = v is not None, desired is not None
        signals = (status.residual, status.threshold, status.torque_correction, q, v, tau, desired)
        stages = [STAGES.index(s) for s in status.stages]
        row = [[status.time], stages, *(self._nothing if s is None else s for s in signals)]
        self._rows += np.concatenate(row).tobytes()

    def finish(self, **record: Any) -> MonitorRun:
        """Return what has been recorded.

        Args:
            **record: Added to the monitor's own record.
        """
        monitor, n = self._monitor, len(self._nothing)
        rows = np.frombuffer(bytes(self._rows)).reshape(-1, 1 + 8 * n)
        stages, *signals = (rows[:, 1 + k * n : 1 + (k + 1) * n] for k in range(8))
        residual, threshold, correction, q, v, tau, desired = signals
        return MonitorRun(
            robot=monitor.model.robot,
            time=rows[:, 0],
            residual=residual,
            threshold=threshold,
            stages=stages.astype(np.uint8),
            torque_correction=correction,
            position=q,
            velocity=v if self._velocity else None,
            effort=tau,
            desired=desired if self._desired else None,
            events=monitor.events,
            faults=monitor.faults,
            record={**monitor.record, **record},
            looks=tuple(self._journal.looks),
            beliefs=tuple(self._journal.beliefs),
        )


def replay(
    monitor: Monitor, log: Log, *, rate: float = STORED, progress: Callable[[float], None] | None = None
) -> MonitorRun:
    """Feed a log to a monitor as a loop would, and return what it said.

    Args:
        monitor: Returned to its start first.
        log: At the rate of the healthy runs.
        rate: Ticks that are kept [Hz].
        progress: Told the share that is done, now and then.

    Raises:
        LogError: If the log is of other joints, or at another rate.
    """
    recorder = Recorder(monitor, rate)
    k = -1

    def watch(status: Status) -> None:
        nonlocal k
        k += 1
        v = None if log.velocity is None else log.velocity[k]
        recorder(status, log.position[k], v, log.effort[k])

    monitor.replay(log, watch, progress)
    return recorder.finish(log={"source": log.source, "sha256": log.sha256, "rate": log.rate})
