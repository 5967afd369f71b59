"""`SafeEngine`: an engine between a check of the samples that it gets and limits of the torques that it asks for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.correction_limits import CorrectionLimits
from cdia_pin.diagnosis.engine_interface import Engine
from cdia_pin.diagnosis.event_history import EventHistory
from cdia_pin.diagnosis.sample_bounds import ANY_SIGNAL, LARGEST_GAP, SampleBounds
from cdia_pin.diagnosis.sample_check import Outcome, SampleCheck
from cdia_pin.diagnosis.sensor_fault import SensorFault
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.status import Event, Stage, Status
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


class SafeEngine(Stateful):
    """Keeps samples that cannot be from an engine, and its corrections within bounds.

    Args:
        engine: The engine.
        robot: The arm.
        bounds: What its samples can be.
        has_velocity: Whether velocities are measured.
        history: Keeps the events of the engine and of the samples.
    """

    STATE = (
        "engine",
        "history",
        "_check",
        "_told",
        "_given",
        "_last",
        "_sample",
        "_nominal",
        "_time",
        "_shift",
    )

    def __init__(
        self,
        engine: Engine,
        robot: RobotModel,
        bounds: SampleBounds,
        has_velocity: bool,
        history: EventHistory,
    ) -> None:
        from cdia_pin.diagnosis import correction_kernel  # needs numba

        self._is_usual = correction_kernel.is_usual
        self.engine, self.history, self._bounds, self._n = engine, history, bounds, robot.n
        self._check = SampleCheck(robot.joints, bounds, has_velocity)
        self._limit = robot.limits.effort
        self._told, self._given = (
            CorrectionLimits(bounds.effort, bounds.speed, bounds.period, engine.nothing) for _ in range(2)
        )
        self._nothing = engine.nothing
        self._forget()

    def _forget(self) -> None:
        self._last = Status(0.0, (Stage.HEALTHY,) * self._n, self._nothing, self._nothing, self._nothing)
        self._sample: tuple[float, Array, Array | None, Array] | None = None
        self._nominal = self._nothing
        self._time = -np.inf  # [s], of the engine: it goes on where the clock of the samples is set back
        self._shift = 0.0  # [s], of the engine's time to that of the samples

    @property
    def sensor_faults(self) -> tuple[SensorFault, ...]:
        """Sensors that are at fault."""
        return self._check.faults

    def reset(self) -> None:
        """Return to the start; what healthy runs taught stays, and whether corrections are allowed."""
        self.engine.reset()
        self.history.reset()
        self._check.reset()
        self._told.reset()
        self._given.reset()
        self._forget()

    def allow_correction(self, allowed: bool) -> None:
        """Let corrections through, or not; they are faded in and out.

        Args:
            allowed: Whether they are let through.
        """
        self._told.is_wanted = self._given.is_wanted = bool(allowed)

    # ------------------------------------------------------------- samples

    def update(self, t: float, q: Array, v: Array | None, tau: Array) -> Status:
        """Take one tick; see `Engine.update`. A sample that cannot be does not reach the engine."""
        outcome = self._check(t, q, v, tau)
        if outcome:
            return self._unusual(outcome, t, q, v, tau)
        return self._pass_on(t, q, v, tau)

    def _pass_on(
        self, t: float, q: Array, v: Array | None, tau: Array, news: tuple[Event, ...] = ()
    ) -> Status:
        """Give a good sample to the engine."""
        elapsed, sensors = t - self._last.time, self._check.sensors
        if sensors.offset is not None:
            q = q - sensors.offset
        self._time = t + self._shift
        status = self.engine.update(self._time, q, v, tau)
        self._sample = t, q, v, tau
        if self._shift:
            self._set_back(status, t)
        self._limit_of_tick(elapsed, True, v)
        status.torque_correction = self._told(status.torque_correction)
        self._check.corrections.append(status.torque_correction)
        status.sensors = sensors.faults
        if news:
            status.events = (*news, *status.events)
        if status.events:
            self.history.add(status.events)
        status.warnings = self.history.warnings
        self._last = status
        return status

    def _unusual(self, outcome: Outcome, t: float, q: Array, v: Array | None, tau: Array) -> Status:
        """Take a sample that is bad, or the first good one after such."""
        news = self._check.news
        if outcome in (Outcome.HELD, Outcome.BAD):
            return self._drop(outcome is Outcome.HELD, t, news)
        if outcome is Outcome.RESTARTED:
            self.engine.pause()
            if not self._time < t + self._shift:
                self._shift = self._time + self._bounds.period - t
        elif self.engine.needs_even_ticks and 0 < self._check.missed <= LARGEST_GAP:
            news = (*news, *self._fill(t, q, v, tau))
        return self._pass_on(t, q, v, tau, news)

    def _drop(self, is_held: bool, t: float, news: tuple[Event, ...]) -> Status:
        """Drop a sample: the diagnosis stays, and the correction is faded out unless the sample is only held back."""
        last = self._last
        time = t if is_held else self._check.last_time
        elapsed = t - last.time
        if abs(elapsed) < self._bounds.longest:
            time = max(t, time)
        self._limit_of_tick(elapsed, is_held, None if self._sample is None else self._sample[2])
        correction = self._told(self._told.asked)
        self.history.add(news)
        self._last = replace(
            last,
            time=time,
            residual=last.residual.copy(),
            threshold=last.threshold.copy(),
            torque_correction=correction,
            events=news,
            sensors=self._check.faults,
            warnings=self.history.warnings,
        )
        return self._last

    def _fill(self, t: float, q: Array, v: Array | None, tau: Array) -> tuple[Event, ...]:
        """Give the engine samples in place of the dropped ones, on the line between the good ones to either side."""
        assert self._sample is not None
        t0, q0, v0, _ = self._sample
        offset = 0.0 if self._check.offset is None else self._check.offset
        news: tuple[Event, ...] = ()
        count = self._check.missed + 1
        for k in range(1, count):
            w = k / count
            speed = None if v is None or v0 is None else v0 + w * (v - v0)
            then = t0 + w * (t - t0)
            status = self.engine.update(then + self._shift, q0 + w * (q - offset - q0), speed, tau)
            self._set_back(status, then)
            news += status.events
        return news

    def _set_back(self, status: Status, t: float) -> None:
        """Turn the times of a status into those of the samples."""
        status.time = t
        status.events = tuple(replace(e, time=e.time - self._shift) for e in status.events)

    def _limit_of_tick(self, elapsed: float, is_trusted: bool, v: Array | None) -> None:
        self._told.tick(elapsed, is_trusted, v)
        self._given.tick(elapsed, is_trusted, v)

    # ------------------------------------------------------------- corrections

    def correct(self, tau: Array, v_desired: Array | None = None) -> Array:
        """Return the torque to command in place of a nominal one; see `Monitor.correct`."""
        if not self._is_usual(tau, ANY_SIGNAL):  # also where it is not a number
            tau = np.clip(np.where(np.isfinite(tau), tau, self._nominal), -ANY_SIGNAL, ANY_SIGNAL)
        if v_desired is not None and not self._is_usual(v_desired, ANY_SIGNAL):
            v_desired = None
        self._nominal = tau
        command = self._given.command(tau, self.engine.correct(tau, v_desired), self._limit)
        self._check.commands.append(command.copy())  # a driver may change the torque that it gets
        return command
