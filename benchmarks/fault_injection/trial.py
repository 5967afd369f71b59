"""One recording with bad samples, replayed by a monitor, and what came of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from benchmarks.fault_injection.kinds import RATE, Kind, Spoil
from benchmarks.fault_injection.recordings import (
    FAULT_AT,
    LENGTH,
    MOTIONS,
    SIZE,
    Recording,
    Samples,
    recordings,
)
from benchmarks.outcomes import JsonLine
from cdia_pin.diagnosis import Monitor, Status, Verdict
from cdia_pin.dynamics import Dynamics
from cdia_pin.robot import load_robot

Array = NDArray[np.float64]

ENGINES = ("momentum", "thesis")
EFFECTS = ("coulomb_friction", "viscous_friction", "torque_offset", "actuator_gain")
SPOILED_AT = (1.0, 1.4)  # [s], between which bad samples begin; what lasts ends 1.2 s before the fault
MOVING = 0.1  # [1], of its largest speed, from which a joint moves
RELEVANT = {Verdict.UNIQUE, Verdict.AMBIGUOUS, Verdict.UNKNOWN}


@dataclass(frozen=True)
class Outcome(JsonLine):
    """What came of a run.

    Attributes:
        id: Name of the run.
        arm: Name of the arm.
        engine: Name of the engine.
        kind: Kind of bad sample.
        ticks: Ticks that were fed.
        raised: Exception; empty if there was none.
        not_finite: Ticks at which a status or a corrected torque was not finite.
        pushed: Largest correction before the fault, of its joint's largest torque [1].
        alarms: Detections before the fault.
        named: Faults of the arm that were named before the fault.
        accused: Sensors named, each as signal and joint.
        expected: Sensor that is to be named; empty if none has to be.
        wrongly: Sensors named that are not at fault.
        seen_after: Time from the fault to its detection [s]; inf if there was none.
    """

    id: str
    arm: str
    engine: str
    kind: str
    ticks: int
    raised: str
    not_finite: int
    pushed: float
    alarms: int
    named: tuple[str, ...]
    accused: tuple[str, ...]
    expected: str
    wrongly: tuple[str, ...]
    seen_after: float

    READ: ClassVar = {"named": tuple, "accused": tuple, "wrongly": tuple}


@lru_cache(maxsize=2)
def monitor_of(arm: str, engine: str) -> Monitor:
    """Return the monitor of an arm, which has learned from healthy minutes."""
    return Monitor(Dynamics(load_robot(arm)), healthy=recordings(arm)[0], bank=EFFECTS, engine=engine)


def run(arm: str, engine: str, kind: Kind, number: int) -> Outcome:
    """Replay a recording with a kind of bad sample.

    Args:
        arm: Name of the arm.
        engine: Name of the engine.
        kind: What is bad.
        number: Number of the run; each draws another tick and joint.
    """
    monitor = monitor_of(arm, engine)
    limit = monitor.model.robot.limits
    learned, all_recordings = recordings(arm)
    recording = all_recordings[number % MOTIONS]
    strongest = np.max([np.abs(log.effort).max(axis=0) for log in learned], axis=0)
    rng = np.random.default_rng(crc32(f"{arm} {kind.name} {number}".encode()))
    at = _place(recording, rng, limit.velocity, strongest)
    with np.errstate(all="ignore"):
        samples = kind.spoil(_with_fault(arm, engine, number % MOTIONS, rng), at)
    expected = f"{kind.accused} of {recording.joints[at.j]}" if kind.accused else ""
    effort = np.where(np.isfinite(limit.effort), limit.effort, strongest)
    watch = _Watch(effort)
    raised = ""
    try:
        watch.replay(monitor, samples)
    except Exception as error:  # the very thing that must not happen
        raised = f"{type(error).__name__}: {error}"
    return Outcome(
        id=f"{arm}/{engine}/{kind.name}/{number}",
        arm=arm,
        engine=engine,
        kind=kind.name,
        ticks=watch.ticks,
        raised=raised,
        not_finite=watch.not_finite,
        pushed=watch.pushed,
        alarms=watch.alarms,
        named=tuple(watch.named),
        accused=tuple(sorted(watch.accused)),
        expected=expected,
        wrongly=() if kind.is_burst else tuple(sorted(watch.accused - {expected})),
        seen_after=watch.seen_after,
    )


def bound_of(monitor: Monitor) -> Array:
    """Return the bound of a healthy residual [N·m or N], shape (n,)."""
    engine: Any = monitor.engine
    return np.asarray(engine.healthy.bound if hasattr(engine, "healthy") else engine.engine.unmodelled)


def _with_fault(arm: str, engine: str, motion: int, rng: np.random.Generator) -> Samples:
    """Return a recording with a real fault at its end, on a joint where the engine sees it without bad samples."""
    recording, bound = recordings(arm)[1][motion], bound_of(monitor_of(arm, engine))
    j = int(rng.choice(visible(arm, engine, motion)))
    return recording.with_friction(j, SIZE * bound[j], round(FAULT_AT * RATE))


@lru_cache(maxsize=8)
def visible(arm: str, engine: str, motion: int) -> tuple[int, ...]:
    """Return the joints on which an engine sees the fault if all samples are good."""
    recording, monitor = recordings(arm)[1][motion], monitor_of(arm, engine)
    begin, bound = round(FAULT_AT * RATE), bound_of(monitor)
    seen = []
    for j in range(len(bound)):
        watch = _Watch(np.full(len(bound), np.inf))
        watch.replay(monitor, recording.with_friction(j, SIZE * bound[j], begin))
        if np.isfinite(watch.seen_after):
            seen.append(j)
    return tuple(seen)


def _place(recording: Recording, rng: np.random.Generator, fastest: Array, strongest: Array) -> Spoil:
    """Draw a tick, and a joint that moves there."""
    k = int(rng.integers(*(round(t * RATE) for t in SPOILED_AT)))
    speed = np.abs(recording.samples.v)
    moving = np.flatnonzero(speed[k] > MOVING * speed.max(axis=0))
    j = int(rng.choice(moving if len(moving) else [int(np.argmax(speed[k] / speed.max(axis=0)))]))
    other = int((j + rng.integers(1, speed.shape[1])) % speed.shape[1])
    return Spoil(k, j, other, rng, fastest, strongest)


class _Watch:
    """What is noted of a replay.

    Args:
        effort: Largest torque of each joint [N·m or N], shape (n,).
    """

    def __init__(self, effort: Array) -> None:
        self._after = round((LENGTH - FAULT_AT) * RATE)  # ticks from the begin of the fault to the end
        self._effort = effort
        self.ticks = self.not_finite = self.alarms = 0
        self.pushed, self.seen_after = 0.0, np.inf
        self.named: list[str] = []
        self.accused: set[str] = set()

    def replay(self, monitor: Monitor, s: Samples) -> None:
        """Feed a monitor as a loop does."""
        monitor.reset()
        fault = len(s.t) - self._after
        most = monitor.model.robot.limits.effort
        last = np.zeros_like(s.nominal[0])
        for k in range(len(s.t)):
            self.ticks += 1
            status = monitor.update(float(s.t[k]), s.q[k], s.v[k], s.tau[k])
            torque = monitor.correct(s.nominal[k], s.desired[k])
            sound = all(
                np.isfinite(x).all()
                for x in (status.time, status.residual, status.threshold, status.torque_correction, torque)
            )
            if not sound or (np.abs(torque) > most).any():
                self.not_finite += 1
            wanted = np.where(np.abs(s.nominal[k]) < 1e6, s.nominal[k], np.nan)  # else anything within limits
            if k < fault:
                pushes = (
                    np.abs([torque - np.clip(wanted, -most, most), status.torque_correction]) / self._effort
                )
                self.pushed = max(self.pushed, float(np.nanmax(pushes)))
            self._note(status, k, fault)
            last = torque
        assert np.isfinite(last).all()

    def _note(self, status: Status, k: int, fault: int) -> None:
        self.accused |= {f"{f.signal} of {f.joint}" if f.joint else str(f.signal) for f in status.sensors}
        for event in status.events:
            detection = event.stage == "detection"
            isolation = event.stage == "isolation" and event.verdict in RELEVANT
            if k >= fault and (detection or isolation):
                self.seen_after = min(self.seen_after, (k - fault) / RATE)
            elif detection:
                self.alarms += 1
            elif isolation:
                said = " with ".join(term.label for term in event.faults)
                self.named.append(said or f"unknown fault of {', '.join(event.joints)}")
