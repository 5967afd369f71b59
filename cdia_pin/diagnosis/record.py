"""`MonitorRun`: the record of a monitored run, for tables, pages and files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NotRequired, TypedDict, cast

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.diagnosis.engines import EngineName
from cdia_pin.diagnosis.journal import BelievedFaults, Journal, Look
from cdia_pin.diagnosis.lasting_changes import Disturbances, LastingChanges, LastingJson, lasting_changes
from cdia_pin.diagnosis.monitor import Monitor
from cdia_pin.diagnosis.monitor_record import MonitorRecord
from cdia_pin.diagnosis.sight import blind_joints
from cdia_pin.diagnosis.status import Event, EventDict, FaultDict, Stage, Status, fault_to_dict
from cdia_pin.effects import Term
from cdia_pin.errors import LogError
from cdia_pin.logs.log import Log
from cdia_pin.logs.recorded_parts import LONGEST_GAP
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

STAGES = tuple(Stage)  # what the numbers in `MonitorRun.stages` mean
STORED_RATE = 100.0  # [Hz] of the ticks that are kept; an hour of seven joints is then 165 MB
ROUNDING = 1e-9  # [s], by which a tick may come early for its turn
SIGNALS = 8  # columns of a row per joint: stages and seven signals


class MonitorDocument(TypedDict):
    """A file of the schema cdia-events/1."""

    schema: str
    robot: str
    joints: list[str]
    events: list[EventDict]
    faults: list[FaultDict]
    tracking_rms: NotRequired[dict[str, float]]
    lasting: NotRequired[LastingJson]
    not_compared: NotRequired[str]
    record: MonitorRecord


@dataclass(frozen=True, eq=False, repr=False)
class MonitorRun:
    """A replay or a closed loop as the monitor recorded it: K ticks of n joints in the robot's order.

    Attributes:
        robot: The arm.
        time: Time of the ticks kept [s], shape (K,).
        residual: Filtered torque that the model lacks [N·m or N], shape (K, n); of the engine ``thesis`` the
            velocity error of its observer [rad/s or m/s].
        threshold: Bound of a healthy arm's residual, in the same unit, shape (K, n).
        stages: Index in `STAGES` of each joint's stage, shape (K, n).
        torque_correction: Torque to add to the nominal one [N·m or N], shape (K, n).
        position: Measured positions [rad or m], shape (K, n).
        velocity: Measured velocities [rad/s or m/s], shape (K, n); None where there are none.
        effort: Torque that acted before the tick [N·m or N], shape (K, n).
        desired: Desired positions [rad or m], shape (K, n); None in a replay.
        events: All events, also those of ticks that are not kept.
        faults: Faults believed at the end.
        record: Engine, bank, settings, healthy runs, thresholds and version.
        looks: Results of isolation on each joint, wherever they changed; none for the engine ``thesis``.
        beliefs: Believed faults with their parameters, wherever they changed.
        lasting: What the last part of a replay differs in from the healthy runs; None where that was not compared.
        not_compared: Why it could not be compared; empty where it was, or nobody asked.
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
    record: MonitorRecord
    looks: tuple[Look, ...] = ()
    beliefs: tuple[BelievedFaults, ...] = ()
    lasting: LastingChanges | None = None
    not_compared: str = ""

    def __repr__(self) -> str:
        faults = ", ".join(t.label for t in self.faults[:3]) or "none"
        size = f"{self.duration:.4g} s, {len(self.events)} events"
        return f"MonitorRun({self.robot.name}, {size}, faults at the end: {faults})"

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, in the order of the columns."""
        return self.robot.joints

    @property
    def duration(self) -> float:
        """Time that was looked at, without gaps [s]; the clock of a later log may start again."""
        steps = np.diff(self.time)
        return float(steps[(steps > 0.0) & (steps <= LONGEST_GAP)].sum())

    @property
    def in_torque(self) -> bool:
        """Whether residuals are torques; otherwise they are velocities."""
        return self.record["engine"] != EngineName.THESIS

    @property
    def blind(self) -> tuple[str, ...]:
        """Names of the joints whose threshold is too wide to see a fault of 30 % of their torque."""
        return tuple(blind_joints(self.record["sight"]))

    @property
    def typical_threshold(self) -> Array:
        """Median of each joint's threshold, which depends on the state [N·m or N], shape (n,)."""
        return np.asarray(np.median(self.threshold, axis=0))

    @property
    def nearness(self) -> Array:
        """Largest residual of each joint over its threshold of that moment [1], shape (n,).

        It may exceed 1 without a detection: for a few ticks, and near rest, where the friction that a model has may be
        off by its size. Where a fault is believed, it is that of the whole residual, and not of what the fault leaves.
        """
        bound = np.where(self.threshold > 0, self.threshold, np.inf)
        return np.asarray((np.abs(self.residual) / bound).max(axis=0))

    def tracking_rms(self, since: float = -np.inf) -> dict[str, float]:
        """Return the RMS of position less desired position of each joint [rad or m]; empty without reference.

        Args:
            since: Begin of the span [s].
        """
        if self.desired is None:
            return {}
        kept = self.time >= since
        error = np.sqrt(np.mean((self.position[kept] - self.desired[kept]) ** 2, axis=0))
        return dict(zip(self.joints, error.tolist(), strict=True))

    def to_dict(self) -> MonitorDocument:
        """Return the run as files of the schema cdia-events/1 have it."""
        more: dict[str, Any] = {} if self.desired is None else {"tracking_rms": self.tracking_rms()}
        if self.lasting is not None:
            more["lasting"] = self.lasting.to_dict()
        if self.not_compared:
            more["not_compared"] = self.not_compared
        out = {
            "schema": schemas.EVENTS,
            "robot": self.robot.name,
            "joints": list(self.joints),
            "events": [e.to_dict(self.robot) for e in self.events],
            "faults": [fault_to_dict(t, self.robot) for t in self.faults],
        }
        return cast("MonitorDocument", {**out, **more, "record": self.record})


class Recorder:
    """Records statuses and signals of a monitor: thinned ticks, and every tick with an event.

    Args:
        monitor: The monitor.
        rate: Rate of the ticks that are kept [Hz]; all of them if the monitor is slower.
    """

    def __init__(self, monitor: Monitor, rate: float = STORED_RATE) -> None:
        self._monitor, self._period = monitor, 1.0 / rate
        self._rows = bytearray()
        self._next = -np.inf
        self._nothing = np.full(monitor.model.robot.n, np.nan)
        self._velocity, self._desired = True, True
        self._events: list[Event] = []
        self._journal = Journal(monitor)

    def __call__(
        self, status: Status, q: Array, v: Array | None, tau: Array, desired: Array | None = None
    ) -> None:
        """Take note of a tick.

        Args:
            status: Status after the tick.
            q: Positions that the monitor got [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,), or None.
            tau: Torque [N·m or N], shape (n,).
            desired: Desired positions [rad or m], shape (n,), or None.
        """
        self._journal(status)
        self._events += status.events
        late = status.time - self._next  # a little below zero: not due; far below: time has gone back
        due = not -2 * self._period < late < 0
        if not due and not status.events:
            return
        if due:
            carried = (
                late if 0 < late < 0.5 * self._period else 0.0
            )  # carried over, so that the rate holds where ticks do not divide it
            self._next = status.time + self._period - carried - ROUNDING
        self._velocity, self._desired = v is not None, desired is not None
        signals = (status.residual, status.threshold, status.torque_correction, q, v, tau, desired)
        stages = [STAGES.index(s) for s in status.stages]
        row = [[status.time], stages, *(self._nothing if s is None else s for s in signals)]
        self._rows += np.concatenate(row).tobytes()

    def finish(self, **record: Any) -> MonitorRun:
        """Return what has been recorded.

        Args:
            **record: Entries added to the monitor's own record, ``log``, ``loop`` or ``notes``.
        """
        monitor, n = self._monitor, len(self._nothing)
        rows = np.frombuffer(bytes(self._rows)).reshape(-1, 1 + SIGNALS * n)
        stages, *signals = (rows[:, 1 + k * n : 1 + (k + 1) * n] for k in range(SIGNALS))
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
            events=tuple(self._events),
            faults=monitor.faults,
            record=cast("MonitorRecord", {**monitor.record, **record}),
            looks=tuple(self._journal.looks),
            beliefs=tuple(self._journal.beliefs),
        )


def replay(
    monitor: Monitor,
    log: Log,
    *,
    rate: float = STORED_RATE,
    progress: Callable[[float], None] | None = None,
    go_on: bool = False,
    compare_with: Sequence[Log] = (),
) -> MonitorRun:
    """Feed a log to a monitor as a loop would, and return the record of the run.

    Args:
        monitor: Returned to its start first, unless it goes on.
        log: Resampled first, if its rate is not that of the monitor, which a note of the record says.
        rate: Rate of the ticks that are kept [Hz].
        progress: Gets the share that is monitored [1], from time to time.
        go_on: Whether the monitor goes on from where it is.
        compare_with: Healthy runs with which the last part of the log is compared, after `lasting_changes`.

    Raises:
        LogError: If the log is of other joints, or has to be resampled and is mostly gaps.
    """
    recorder = Recorder(monitor, rate)
    even = monitor.at_rate(log)
    said = [] if even is log else [f"{log.source}: {even.notes[-1]}"]
    if remark := monitor.remark(even):
        said.append(remark)
    disturbed = Disturbances()

    def watch(status: Status) -> None:
        k = len(disturbed)
        disturbed.see(status)
        v = None if even.velocity is None else even.velocity[k]
        recorder(status, even.position[k], v, even.effort[k])

    monitor.replay(even, watch, progress, go_on=go_on)
    source = {"source": log.source, "sha256": log.sha256, "rate": log.rate}
    run = recorder.finish(log=source, notes=[*said, *monitor.record["notes"]])
    if not compare_with:
        return run
    if progress is not None:
        progress(1.0)
    try:
        lasting = lasting_changes(monitor.model, compare_with, even, disturbed=disturbed.mask)
    except LogError as why:
        return replace(run, not_compared=str(why))
    return replace(run, lasting=lasting)
