"""`Monitor`: one object that watches an arm while it moves, one call a tick."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.diagnosis.bank import DEFAULT_BANK, Bank
from cdia_pin.diagnosis.engines import ENGINES, Knowledge
from cdia_pin.diagnosis.settings import MonitorSettings
from cdia_pin.diagnosis.status import Event, Status
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import JointEffect, Term
from cdia_pin.errors import LogError, ModelError, unknown_name
from cdia_pin.logs.log import Log
from cdia_pin.version import __version__

if TYPE_CHECKING:
    from cdia_pin.diagnosis.thesis import ThesisSettings

Array = NDArray[np.float64]

SAME_RATE = 1.2  # [1], how far rates may differ


class Monitor:
    """Notice a change of an arm, name it, correct for it, and notice when it is gone.

        monitor = Monitor(Dynamics(robot), healthy=[log])
        while True:
            status = monitor.update(t, q, v, tau)      # tau: the torque since the last tick
            tau = monitor.correct(nominal_torque)      # or nominal_torque + status.torque_correction

    Args:
        model: What the arm is while it is healthy.
        healthy: Runs of the healthy arm, at the rate of the ticks, to learn thresholds from.
        threshold: Largest healthy residual of each joint [N·m or N], where there are no such runs.
        rate: Ticks per second, where there are no such runs [Hz].
        position_only: Whether `update` gets no velocities, where there are no such runs.
        bank: Known effects that are asked of every joint.
        engine: ``momentum`` or ``thesis``, the scheme as the thesis has it.
        settings: Of the engine; `MonitorSettings` or `ThesisSettings`.

    Attributes:
        record: Engine, bank, settings, model, healthy runs, what they taught, and version; plain JSON.

    Raises:
        ModelError: If neither or both of runs and thresholds are given, the engine is unknown, or the settings
            are not its own.
        LogError: If the runs are too short or differ in rate.
        EffectError: If the bank names what is not an effect of one joint.
    """

    def __init__(
        self,
        model: Dynamics,
        *,
        healthy: Sequence[Log] = (),
        threshold: Mapping[str, float] | None = None,
        rate: float | None = None,
        position_only: bool = False,
        bank: Bank | Iterable[str | JointEffect] = DEFAULT_BANK,
        engine: str = "momentum",
        settings: MonitorSettings | ThesisSettings | None = None,
    ) -> None:
        if threshold is not None:
            _check_threshold(threshold, model)
        if engine not in ENGINES:
            raise ModelError(unknown_name("engine", engine, ENGINES))
        if healthy and threshold is not None:
            raise ModelError("a monitor takes healthy runs or a threshold, not both")
        self.model, self.bank = model, bank if isinstance(bank, Bank) else Bank.of(model.robot, bank)
        self.rate = float(np.median([run.rate for run in healthy])) if healthy else rate
        self._shape = (model.robot.n,)
        self._limit = model.robot.limits.effort
        known = Knowledge(tuple(healthy), threshold, rate, position_only)
        self.engine, used = ENGINES[engine](model, self.bank, settings, known)
        self.record: dict[str, Any] = {
            "version": __version__,
            "engine": engine,
            "bank": list(self.bank.names),
            "settings": _plain(asdict(used)),
            "model": [term.label for term in model.terms],
            "healthy": [{"source": r.source, "sha256": r.sha256, "duration": r.duration} for r in healthy],
            "rate": self.rate,
            "notes": list(self.engine.notes),
        }

    def update(self, t: float, q: ArrayLike, v: ArrayLike | None, tau: ArrayLike) -> Status:
        """Take one tick.

        A sample that is not finite, or not later than the last, is answered by nominal control: no correction
        until data have been good for a while. Nothing is raised in a control loop for what a sensor does.

        Args:
            t: Time [s].
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,); None where the robot has none.
            tau: Torque that has acted since the last tick [N·m or N], shape (n,).

        Raises:
            ModelError: If a signal has another shape.
        """
        q, tau = np.asarray(q, float), np.asarray(tau, float)
        v = None if v is None else np.asarray(v, float)
        if q.shape != self._shape or tau.shape != self._shape or (v is not None and v.shape != self._shape):
            given = ", ".join(str(np.shape(s)) for s in (q, v, tau) if s is not None)
            raise ModelError(f"a tick takes signals of shape {self._shape}, given {given}")
        return self.engine.update(t, q, v, tau)

    def correct(self, tau: ArrayLike, v_desired: ArrayLike | None = None) -> Array:
        """Return the torque to command in place of a nominal one, within the effort limits [N·m or N], shape (n,).

        Args:
            tau: The nominal torque [N·m or N], shape (n,).
            v_desired: Velocity asked for [rad/s or m/s], shape (n,). Dry friction is compensated in its direction,
                so that a joint that rests where it should move is set going; the measured one if omitted.

        Raises:
            ModelError: If a signal has another shape.
        """
        nominal = np.asarray(tau, float)
        asked = None if v_desired is None else np.asarray(v_desired, float)
        if nominal.shape != self._shape or (asked is not None and asked.shape != self._shape):
            given = ", ".join(str(s.shape) for s in (nominal, asked) if s is not None)
            raise ModelError(f"a correction takes signals of shape {self._shape}, given {given}")
        return np.minimum(np.maximum(self.engine.correct(nominal, asked), -self._limit), self._limit)

    @property
    def events(self) -> tuple[Event, ...]:
        """All events so far."""
        return tuple(self.engine.events)

    @property
    def faults(self) -> tuple[Term, ...]:
        """Faults now believed in."""
        return self.engine.faults

    def improved_model(self) -> Dynamics:
        """Return the model with the faults now believed in as terms: of a fault of the same name, the sum."""
        terms = []
        for term in self.faults:
            same = next((t for t in self.model.terms if t.label == term.label), None)
            theta = np.array(term.theta) + (0 if same is None else np.array(same.theta))
            terms.append(Term(term.effect, tuple(theta), term.profile, term.ci95 if same is None else None))
        return self.model.add(*terms)

    def reset(self) -> None:
        """Return to the start, keeping what healthy runs taught."""
        self.engine.reset()

    def replay(
        self,
        log: Log,
        watch: Callable[[Status], None] | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> tuple[Event, ...]:
        """Feed a log sample by sample, just as a loop would; returns the events.

        Args:
            log: At the rate of the healthy runs.
            watch: Told the status after each sample.
            progress: Told the share that is done, now and then.

        Raises:
            LogError: If the log is of other joints, or at another rate.
        """
        if log.joints != self.model.robot.joints:
            expected = ", ".join(self.model.robot.joints)
            raise LogError(f"{log.source}: joints are {', '.join(log.joints)}; expected {expected}")
        self.reset()
        count = len(log.time)
        if self.rate and not 1 / SAME_RATE < log.rate / self.rate < SAME_RATE:
            raise LogError(
                f"{log.source}: {log.rate:.4g} Hz, but the monitor's thresholds are of {self.rate:.4g} Hz; give a "
                "log and healthy runs of one rate"
            )
        for k in range(count):
            v = None if log.velocity is None else log.velocity[k]
            status = self.update(float(log.time[k]), log.position[k], v, log.effort[k])
            if watch is not None:
                watch(status)
            if progress is not None and k % 500 == 0:
                progress(k / count)
        return self.events


def _check_threshold(threshold: Mapping[str, float], model: Dynamics) -> None:
    joints = model.robot.joints
    for joint, value in threshold.items():
        if joint not in joints:
            raise ModelError("threshold: " + unknown_name("joint", joint, joints))
        if not 0 < value < np.inf:
            raise ModelError(f"threshold of {joint} must be above 0, given {value}")
    if missing := [j for j in joints if j not in threshold]:
        raise ModelError(f"threshold: no value for joint(s) {', '.join(missing)}")


def _plain(value: Any) -> Any:
    """Return settings as JSON has them."""
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    return value if isinstance(value, str | bool | int | float) or value is None else str(value)
