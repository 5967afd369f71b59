"""`Monitor`: monitors an arm while it moves, one call per tick."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.engine_interface import Engine
from cdia_pin.diagnosis.engines import ENGINES, Knowledge, require_threshold
from cdia_pin.diagnosis.event_history import EventHistory
from cdia_pin.diagnosis.monitor_file import MonitorParts, reading, write_monitor
from cdia_pin.diagnosis.monitor_record import MonitorRecord
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.safe_engine import SafeEngine
from cdia_pin.diagnosis.sample_bounds import SampleBounds
from cdia_pin.diagnosis.sensor_fault import SensorFault
from cdia_pin.diagnosis.status import Event, Status
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import ExternalWrench, JointEffect, Term
from cdia_pin.errors import EffectError, LogError, ModelError, unknown_name
from cdia_pin.logs.log import Log
from cdia_pin.logs.magnitudes import require_magnitudes
from cdia_pin.logs.recorded_parts import between_gaps
from cdia_pin.logs.resampling import resampled, thinned
from cdia_pin.logs.torque_side import BEHIND_THE_GEAR, TorqueSide, side_of_all
from cdia_pin.logs.wild_samples import without_wild_samples
from cdia_pin.plain_json import plain
from cdia_pin.robot.model import RobotModel
from cdia_pin.version import __version__

if TYPE_CHECKING:
    from cdia_pin.diagnosis.thesis import ThesisSettings

Array = NDArray[np.float64]

# [1], largest ratio of two rates that count as one: the medians of one recorder's rates differ by less, and noise of a
# residual changes by 2 %
SAME_RATE = 1.05
ASSUMED_RATE = 1000.0  # [Hz], where the engine needs none and none is given
SHORTEST_PART = (
    1.0  # [s], of a healthy run between two gaps: in a shorter one the slowest filter does not settle
)
PROGRESS_EVERY = 500  # samples between two reports of a replay's progress


class Monitor:
    """Detects a change of an arm, isolates its cause, compensates it, and notices when it has cleared.

        monitor = Monitor(Dynamics(robot), healthy=[log])
        while True:
            status = monitor.update(t, q, v, tau)      # tau: the torque since the last tick
            tau = monitor.correct(nominal_torque)      # or nominal_torque + status.torque_correction

    Args:
        model: The healthy arm.
        healthy: Runs of the healthy arm, from which thresholds are learned; those of another rate are resampled.
        threshold: Largest healthy residual of each joint [N·m or N], if there are no healthy runs.
        rate: Ticks per second [Hz]; the median rate of the healthy runs if omitted.
        position_only: Whether `update` gets no velocities, if there are no healthy runs.
        bank: Known effects; each is tested on every joint. If omitted, the usual ones that the torque sensors of the
            healthy runs see, or those of the runs that the model was learned from.
        engine: ``momentum``, or ``thesis`` for the scheme of [Thesis].
        settings: Settings of the engine, `MonitorSettings` or `ThesisSettings`; the defaults if omitted.
        event_log: File to which every event is appended as a line of JSON; none if omitted.

    Attributes:
        record: Engine, bank, settings, model, healthy runs, what they taught, and version; plain JSON.

    Raises:
        ModelError: If neither or both of runs and thresholds are given, the engine is unknown, the settings
            belong to another engine, or the event log cannot be written.
        LogError: If the runs are too short, or more than 1 % of their samples are such as no motion makes.
        EffectError: If the bank holds something other than effects of one joint.
    """

    def __init__(
        self,
        model: Dynamics,
        *,
        healthy: Sequence[Log] = (),
        threshold: Mapping[str, float] | None = None,
        rate: float | None = None,
        position_only: bool = False,
        bank: Bank | Iterable[str | JointEffect] | None = None,
        engine: str = "momentum",
        settings: MonitorSettings | ThesisSettings | None = None,
        event_log: str | Path | None = None,
    ) -> None:
        if threshold is not None:
            require_threshold(threshold, model.robot)
        if engine not in ENGINES:
            raise ModelError(unknown_name("engine", engine, ENGINES))
        if healthy and threshold is not None:
            raise ModelError("a monitor takes healthy runs or a threshold, not both")
        history = EventHistory.to(event_log, model.robot)
        # a log may belie its format
        stated = side_of_all(run.torque_side for run in healthy if not run.side_of_format)
        side = model.torque_side if stated is TorqueSide.UNKNOWN else stated
        is_behind = bank is None and side is TorqueSide.LINK
        if bank is None:
            bank = Bank.usual(model.robot, side)
        bank = bank if isinstance(bank, Bank) else Bank.of(model.robot, bank)
        self.rate = rate or (float(np.median([run.rate for run in healthy])) if healthy else None)
        kept = [without_wild_samples(run, velocities=True) for run in healthy]
        for run in kept:
            require_magnitudes(run)
        runs = [self.at_rate(run, healthy=True) for run in kept]
        said = [
            f"{run.source}: {note}"
            for run, given in zip(runs, healthy, strict=True)
            for note in run.notes[len(given.notes) :]
        ]
        # a gap is no tick: with bounds learned across gaps, each gap of a watched log accuses all velocity sensors
        runs = [part for run in runs for part in between_gaps(run, SHORTEST_PART)]
        known = Knowledge(tuple(runs), threshold, self.rate, position_only)
        made, used = ENGINES[engine](model, bank, settings, known)
        if healthy:
            bounds, has_velocity = SampleBounds.learned(model.robot, runs), runs[0].velocity is not None
        else:
            bounds = SampleBounds.assumed(model.robot, self.rate or ASSUMED_RATE)
            has_velocity = not position_only
        record: MonitorRecord = {
            "version": __version__,
            "engine": str(engine),
            "bank": list(bank.names),
            "settings": plain(asdict(used)),
            "model": [term.label for term in model.terms],
            "healthy": [{"source": r.source, "sha256": r.sha256, "duration": r.duration} for r in healthy],
            "rate": self.rate,
            "notes": [*said, *([BEHIND_THE_GEAR] if is_behind else []), *made.notes],
            "sight": made.sight,
        }
        parts = MonitorParts(model, bank, used, self.rate, has_velocity, bounds, made.learned, record)
        self._assemble(parts, made, history)

    def _assemble(self, parts: MonitorParts, engine: Engine, history: EventHistory) -> None:
        """Put the parts together."""
        robot = parts.model.robot
        self.model, self.bank, self.rate, self.record = parts.model, parts.bank, parts.rate, parts.record
        self.engine, self._parts = engine, parts
        self._shape, self._has_velocity = (robot.n,), parts.has_velocity
        self._safe = SafeEngine(engine, robot, parts.bounds, parts.has_velocity, history)

    @classmethod
    def load(cls, path: str | Path, robot: RobotModel, *, event_log: str | Path | None = None) -> Monitor:
        """Return a monitor as it was when `save` wrote it; it goes on as if it had never been stopped.

        Args:
            path: The file.
            robot: The arm.
            event_log: Gets every event from now on.

        Raises:
            ModelError: If the file is no stored monitor, or one of another arm or version of the package.
        """
        with reading(path, robot) as stored:
            monitor = cls.__new__(cls)
            history = EventHistory.to(event_log, robot)
            monitor._assemble(stored.parts, stored.parts.engine(), history)
            stored.restore(monitor._safe)
        return monitor

    def save(self, path: str | Path) -> Path:
        """Write the monitor as it is now, with all that it has learned and believes; its event log is not part of it.

        Args:
            path: File to write, best named ``.npz``; an existing one is replaced as a whole or not at all.

        Returns:
            The path that was written.

        Raises:
            ModelError: If the file cannot be written, or the model or the bank holds an effect whose class has no
                name in the vocabulary, see `effects.register`.
        """
        return write_monitor(path, self._parts, self._safe)

    def __repr__(self) -> str:
        robot, faults = self.model.robot, ", ".join(t.label for t in self.faults[:3]) or "none"
        return f"Monitor({robot.name}, {self.record['engine']}, {len(self.bank)} effects, faults: {faults})"

    def update(self, t: float, q: ArrayLike, v: ArrayLike | None, tau: ArrayLike) -> Status:
        """Take one tick and return the diagnosis.

        A sample that cannot be is dropped, and corrections are faded out until samples are good again: not finite,
        beyond the limits of the arm, a jump that no acceleration makes, a signal that stays the same while the arm
        moves, or a time that is not later than the last. A bad sensor raises no exception in the control loop.

        Args:
            t: Time [s].
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,); None where the robot does not measure them.
            tau: Torque that has acted since the last tick [N·m or N], shape (n,).

        Raises:
            ModelError: If a signal has another shape, or velocities are missing that the healthy runs have.
        """
        # copies: a driver may use its buffers again, and compiled code takes one layout of memory
        q, tau = np.array(q, float), np.array(tau, float)
        v = None if v is None else np.array(v, float)
        if q.shape != self._shape or tau.shape != self._shape or (v is not None and v.shape != self._shape):
            given = ", ".join(str(np.shape(s)) for s in (q, v, tau) if s is not None)
            raise ModelError(f"a tick takes signals of shape {self._shape}, given {given}")
        if v is None and self._has_velocity:
            raise ModelError(
                "a tick without velocities: give them, or let the monitor learn from runs without velocities"
            )
        return self._safe.update(float(t), q, v, tau)

    def correct(self, tau: ArrayLike, v_desired: ArrayLike | None = None) -> Array:
        """Return the torque to command instead of a nominal one, within the effort limits [N·m or N], shape (n,).

        What is added is finite, and bounded in size, rate and power; it is faded in and out. A nominal torque that
        is not finite is replaced by the last finite one of its joint, by zero before any.

        Args:
            tau: The nominal torque [N·m or N], shape (n,).
            v_desired: Desired velocity [rad/s or m/s], shape (n,). Dry friction is compensated in its direction, so
                that a joint at rest starts to move; the measured velocity if omitted.

        Raises:
            ModelError: If a signal has another shape.
        """
        nominal = np.array(tau, float)
        asked = None if v_desired is None else np.array(v_desired, float)
        if nominal.shape != self._shape or (asked is not None and asked.shape != self._shape):
            given = ", ".join(str(s.shape) for s in (nominal, asked) if s is not None)
            raise ModelError(f"a correction takes signals of shape {self._shape}, given {given}")
        return self._safe.correct(nominal, asked)

    def allow_correction(self, allowed: bool) -> None:
        """Allow or veto corrections, of `correct` and of `Status.torque_correction`; diagnosis goes on.

        They are faded in and out within 0.1 s. A veto stays through `reset`.

        Args:
            allowed: Whether torques may be corrected; they may from the start.
        """
        self._safe.allow_correction(allowed)

    @property
    def events(self) -> tuple[Event, ...]:
        """The last events, at most `event_history.MOST_EVENTS`; an event log holds all."""
        return tuple(self._safe.history.events)

    @property
    def sensor_faults(self) -> tuple[SensorFault, ...]:
        """Sensors that are at fault."""
        return self._safe.sensor_faults

    @property
    def faults(self) -> tuple[Term, ...]:
        """Believed faults."""
        return self.engine.faults

    def improved_model(self) -> Dynamics:
        """Return the model with the believed faults as terms; parameters of the same effect are added.

        A contact is no part of it.

        Raises:
            EffectError: If the model has an effect of a fault in another shape or at other times.
        """
        terms: list[Term] = []
        for term in self.faults:
            if isinstance(term.effect, ExternalWrench):
                continue  # it is gone with the contact
            same = next((t for t in self.model.terms if t.label == term.label), None)
            if same is not None and (same.effect, same.profile) != (term.effect, term.profile):
                why = "another shape" if same.effect != term.effect else "other times"
                raise EffectError(
                    f"the model has {term.label} in {why} than the fault, so they cannot be added up"
                )
            theta = np.array(term.theta) + (0 if same is None else np.array(same.theta))
            terms.append(Term(term.effect, tuple(theta), term.profile, term.ci95 if same is None else None))
        return self.model.add(*terms)

    def reset(self) -> None:
        """Return to the start; what healthy runs taught stays."""
        self._safe.reset()

    def at_rate(self, log: Log, *, healthy: bool = False) -> Log:
        """Return a log at the rate of the ticks: itself, or resampled, which its last note says.

        Args:
            log: Any log.
            healthy: Whether thresholds are learned from it; a faster one then keeps the noise of its samples.

        Raises:
            LogError: If most of the log is gaps.
        """
        if not self.rate or 1 / SAME_RATE < log.rate / self.rate < SAME_RATE:
            return log
        return (thinned if healthy and log.rate > self.rate else resampled)(log, self.rate)

    def remark(self, log: Log) -> str:
        """Return a sentence if a log was recorded otherwise than the healthy runs, so that it looks like bad sensors.

        Args:
            log: At the rate of the ticks.

        Returns:
            Empty if nothing is to be said.
        """
        return self._parts.bounds.rougher(log)

    def replay(
        self,
        log: Log,
        watch: Callable[[Status], None] | None = None,
        progress: Callable[[float], None] | None = None,
        *,
        go_on: bool = False,
    ) -> tuple[Event, ...]:
        """Feed a log sample by sample, as a loop would, and return all its events.

        Args:
            log: Resampled first, if its rate is not that of the ticks.
            watch: Gets the status after each sample.
            progress: Gets the share that is done [1], from time to time.
            go_on: Whether the monitor goes on from where it is; it returns to its start first if not.

        Raises:
            LogError: If the log is of other joints, or has to be resampled and is mostly gaps.
        """
        if log.joints != self.model.robot.joints:
            expected = ", ".join(self.model.robot.joints)
            raise LogError(f"{log.source}: joints are {', '.join(log.joints)}; expected {expected}")
        if not go_on:
            self.reset()
        log = self.at_rate(log)
        count = len(log.time)
        events: list[Event] = []
        for k in range(count):
            v = None if log.velocity is None else log.velocity[k]
            status = self.update(float(log.time[k]), log.position[k], v, log.effort[k])
            events += status.events
            if watch is not None:
                watch(status)
            if progress is not None and k % PROGRESS_EVERY == 0:
                progress(k / count)
        return tuple(events)
