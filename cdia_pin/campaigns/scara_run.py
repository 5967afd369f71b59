"""Simulation of the thesis' SCARA arm on its trajectory: closed form, classical Runge–Kutta, faults of any size.

Model and integrator differ from those of the engine under study: the arm moves by its closed form and not by
Pinocchio's algorithms, and its torque is held between ticks while a fourth-order method takes several steps.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.status import Event, Stage
from cdia_pin.diagnosis.thesis import ThesisEngine
from cdia_pin.effects import JointEffect, JointState
from cdia_pin.errors import ModelError
from cdia_pin.progress import Progress, part, silent
from cdia_pin.robot import scara

Array = NDArray[np.float64]

UNITS = ("rad", "rad", "rad", "m")
AMPLITUDE = np.pi * np.array([5 / 6, 7 / 9, 1 / 2, 0.2 / np.pi])  # [rad, rad, rad, m]
FREQUENCY = np.pi * np.array([1 / 3, 1 / 3, 1 / 3, 1.2 / np.pi])  # [rad/s]
STIFFNESS = np.array([30.0, 60.0, 90.0, 60.0])  # K_p [1/s²], of the thesis' appendix
DAMPING = np.array([10.0, 25.0, 45.0, 25.0])  # K_v [1/s], of the thesis' appendix
PRINTED_START = np.pi * np.array([1 / 2, -2 / 3, -1 / 2, -0.1 / np.pi])  # [rad, rad, rad, m]
FASTEST = 1e4  # [rad/s or m/s], a run with a larger speed has diverged: no arm is nearly as fast
WATCHED = 50  # [ticks], between two calls of ``until``
REPORTED = 200  # [ticks], between two reports of progress


@dataclass(frozen=True, eq=False, repr=False)
class Fault:
    """A known effect on all joints at once, between two times.

    Attributes:
        effect: The effect; its joint is ignored.
        theta: Parameters [units of the effect], one row per joint, shape (n, p).
        start: Onset [s].
        end: End [s].
    """

    effect: JointEffect
    theta: Array
    start: float
    end: float = np.inf

    def __repr__(self) -> str:
        return (
            f"Fault({self.effect.name} on {len(self.theta)} joints, from {self.start:g} s to {self.end:g} s)"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Scenario:
    """Faults and conditions of a run.

    Attributes:
        faults: The faults, with their times.
        unmodelled: Size of η = size · ½(cos 5q + sin 15q̇) [N·m or N], shape (4,); η is always present.
        start: Positions at the beginning [rad, rad, rad, m], shape (4,); None to start on the trajectory, moving.
        duration: Length [s].
        tick: Time between samples, over which the torque is held [s].
        substeps: Runge–Kutta steps per tick [1].
        sign_width: Speed below which the plant's sgn q̇ is smoothed [rad/s or m/s].
    """

    faults: tuple[Fault, ...]
    unmodelled: Array
    start: Array | None = None
    duration: float = 10.0
    tick: float = 1e-3
    substeps: int = 1
    sign_width: float = 0.01

    def __repr__(self) -> str:
        return f"Scenario({len(self.faults)} faults, {self.duration:g} s)"

    @property
    def healthy(self) -> Scenario:
        """The same conditions without faults."""
        return replace(self, faults=())


@dataclass(frozen=True, eq=False, repr=False)
class ScaraRun:
    """A run of the SCARA arm, K samples.

    Attributes:
        time: Time [s], shape (K,).
        q: Positions [rad or m], shape (K, 4).
        v: Velocities [rad/s or m/s], shape (K, 4).
        q_error: q − q_d [rad or m], shape (K, 4).
        v_error: q̇ − q̇_d [rad/s or m/s], shape (K, 4).
        effort: Torque from each sample on [N·m or N], shape (K, 4).
        residual: Velocity estimation error of the observer [rad/s or m/s], shape (K, 4); zero without an engine.
        threshold: Detection threshold of the residual [rad/s or m/s], shape (K, 4).
        stages: Gravest stage at each sample; empty without an engine.
        events: Events of the engine.
    """

    time: Array
    q: Array
    v: Array
    q_error: Array
    v_error: Array
    effort: Array
    residual: Array
    threshold: Array
    stages: tuple[Stage, ...]
    events: tuple[Event, ...]

    def __repr__(self) -> str:
        return f"ScaraRun({len(self.time)} samples, {self.time[-1]:.4g} s, {len(self.events)} events)"

    def tracking(self, start: float, end: float = np.inf) -> Array:
        """Compute the RMS position error between two times.

        Args:
            start: First time [s].
            end: Last time [s].

        Returns:
            RMS error [rad, rad, rad, m], shape (4,).
        """
        kept = (self.time >= start) & (self.time <= end)
        rms: Array = np.sqrt(np.mean(self.q_error[kept] ** 2, axis=0, dtype=np.float64))
        return rms


def desired(t: float) -> tuple[Array, Array, Array]:
    """Compute the desired motion q_d, q̇_d, q̈_d of the appendix.

    Args:
        t: Time [s].

    Returns:
        Positions [rad or m], velocities [1/s] and accelerations [1/s²] of these, shape (4,) each.
    """
    s, c = np.sin(FREQUENCY * t), np.cos(FREQUENCY * t)
    q, v, a = AMPLITUDE * s, AMPLITUDE * FREQUENCY * c, -AMPLITUDE * FREQUENCY**2 * s
    return q, v, a


@dataclass(frozen=True, eq=False)
class Job:
    """A run to come.

    Attributes:
        scenario: Faults and conditions.
        engine: Monitors the run, and compensates if its settings allow it; None for no engine.
        until: Ends the run early if it returns True of the events so far; called now and then.
    """

    scenario: Scenario
    engine: ThesisEngine | None = None
    until: Callable[[Sequence[Event]], bool] = lambda _: False


def run(
    scenario: Scenario,
    engine: ThesisEngine | None = None,
    until: Callable[[Sequence[Event]], bool] = lambda _: False,
) -> ScaraRun:
    """Let the arm follow the trajectory under computed torque, with or without an engine that compensates.

    Args:
        scenario: Faults and conditions.
        engine: Monitors the run, and compensates if its settings allow it; None for no engine.
        until: Ends the run early if it returns True of the events so far; called now and then.

    Returns:
        Motion, tracking errors and the output of the engine.

    Raises:
        ModelError: If the run diverges.
    """
    return run_together([Job(scenario, engine, until)])[0]


def run_together(jobs: Sequence[Job], progress: Progress = silent) -> tuple[ScaraRun, ...]:
    """Run several arms at once; each moves as if alone, and the steps of all are computed together.

    Args:
        jobs: The runs.
        progress: Called with the current work and the share that is done [1].

    Returns:
        The runs in the order of the jobs.

    Raises:
        ModelError: If a run diverges.
    """
    kinds: dict[tuple[float, int, float], list[int]] = {}
    for i, job in enumerate(jobs):
        scenario = job.scenario
        kinds.setdefault((scenario.tick, scenario.substeps, scenario.sign_width), []).append(i)
    weights = [max(jobs[i].scenario.duration for i in each) * len(each) for each in kinds.values()]
    found: dict[int, ScaraRun] = {}
    done = 0.0
    for each, weight in zip(kinds.values(), weights, strict=True):
        end = done + weight / sum(weights)
        runs = _run_alike([jobs[i] for i in each], part(progress, done, end))
        found.update(zip(each, runs, strict=True))
        done = end
    return tuple(found[i] for i in range(len(jobs)))


def _run_alike(jobs: Sequence[Job], progress: Progress) -> list[ScaraRun]:
    """Run arms whose ticks and steps are alike."""
    tick = jobs[0].scenario.tick
    counts = [round(job.scenario.duration / tick) + 1 for job in jobs]
    time = np.arange(max(counts), dtype=np.float64) * tick
    names = ("q", "v", "q_error", "v_error", "effort", "residual", "threshold")
    out = {name: np.zeros((len(time), len(jobs), 4)) for name in names}
    stages: list[list[Stage]] = [[] for _ in jobs]
    events: list[list[Event]] = [[] for _ in jobs]
    start_q, start_v, _ = desired(0.0)
    moving = [job.scenario.start is None for job in jobs]
    q = np.array([start_q if job.scenario.start is None else job.scenario.start for job in jobs])
    v = np.where(np.array(moving)[:, None], start_v, np.zeros((len(jobs), 4)))
    tau = np.zeros((len(jobs), 4))
    live = list(range(len(jobs)))
    steps = _Steps([job.scenario for job in jobs])
    for k, t in enumerate(time.tolist()):
        if k % REPORTED == 0:
            progress(f"{len(live)} runs at {t:.1f} s of {time[-1]:.1f} s", k / len(time))
        q_d, v_d, a_d = desired(t)
        wanted = a_d - STIFFNESS * (q - q_d) - DAMPING * (v - v_d)
        M, nle = scara.mass_matrix(q), scara.nonlinear_effects(q, v)
        nominal = [M[i] @ wanted[i] + nle[i] for i in range(len(live))]
        for i, j in enumerate(live):
            engine = jobs[j].engine
            if engine is not None:
                status = engine.update(t, q[i], v[i], tau[i])
                out["residual"][k, j], out["threshold"][k, j] = status.residual, status.threshold
                stages[j].append(status.stage)
                events[j] += status.events
                nominal[i] = engine.correct(nominal[i])
        tau = np.array(nominal)
        for name, value in (("q", q), ("v", v), ("q_error", q - q_d), ("v_error", v - v_d), ("effort", tau)):
            out[name][k, live] = value
        q, v = steps.advance(t, q, v, tau)
        if not np.abs(v).max() < FASTEST:
            raise ModelError(f"the simulation of the SCARA arm diverged at {t:.3g} s")
        watched = k % WATCHED == 0
        kept = [
            i for i, j in enumerate(live) if k + 1 < counts[j] and not (watched and jobs[j].until(events[j]))
        ]
        if len(kept) < len(live):
            for i, j in enumerate(live):
                if i not in kept:
                    counts[j] = k + 1
            live, q, v, tau = [live[i] for i in kept], q[kept], v[kept], tau[kept]
            steps = _Steps([jobs[j].scenario for j in live])
        if not live:
            break
    return [
        ScaraRun(
            time[: counts[j]],
            **{name: signal[: counts[j], j].copy() for name, signal in out.items()},
            stages=tuple(stages[j]),
            events=tuple(events[j]),
        )
        for j in range(len(jobs))
    ]


class _Steps:
    """Steps of classical Runge–Kutta of several arms, with constant torques.

    Args:
        scenarios: Their scenarios, alike in ticks and steps.
    """

    def __init__(self, scenarios: Sequence[Scenario]) -> None:
        self._scenarios = scenarios
        self._unmodelled = np.array([0.5 * s.unmodelled for s in scenarios]).reshape(-1, 4)
        self._present: tuple[tuple[Fault, ...], ...] | None = None
        self._acting: dict[JointEffect, Array] = {}  # parameters, shape (p, N, 4) each

    def advance(self, t: float, q: Array, v: Array, tau: Array) -> tuple[Array, Array]:
        """Integrate over one tick; positions, velocities and torques have shape (N, 4)."""
        first = self._scenarios[0]
        h = first.tick / first.substeps
        self._choose(t)
        for i in range(first.substeps):
            at = t + i * h
            a1 = self._acceleration(at, q, v, tau)
            q2, v2 = q + 0.5 * h * v, v + 0.5 * h * a1
            a2 = self._acceleration(at, q2, v2, tau)
            q3, v3 = q + 0.5 * h * v2, v + 0.5 * h * a2
            a3 = self._acceleration(at, q3, v3, tau)
            q4, v4 = q + h * v3, v + h * a3
            a4 = self._acceleration(at, q4, v4, tau)
            q = q + h / 6 * (v + 2 * v2 + 2 * v3 + v4)
            v = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        return q, v

    def _choose(self, t: float) -> None:
        """Take the faults that are present; each effect is evaluated once for all arms, which have it or not."""
        present = tuple(tuple(f for f in s.faults if f.start - 1e-9 <= t < f.end) for s in self._scenarios)
        if present == self._present:
            return
        self._present, self._acting = present, {}
        for i, fault in ((i, fault) for i, faults in enumerate(present) for fault in faults):
            none = np.zeros((fault.effect.size, len(present), 4))
            self._acting.setdefault(fault.effect, none)[:, i] += fault.theta.T

    def _acceleration(self, t: float, q: Array, v: Array, tau: Array) -> Array:
        push = tau - scara.nonlinear_effects(q, v)
        push -= self._unmodelled * (np.cos(5 * q) + np.sin(15 * v))
        if self._acting:
            sign = np.tanh(v / self._scenarios[0].sign_width)
            x = JointState(q, v, np.zeros_like(q), tau, sign, np.full_like(q, t))
            for effect, theta in self._acting.items():
                for column, of_each in zip(effect.columns(x), theta, strict=True):
                    push += column * of_each
        return np.asarray(np.linalg.solve(scara.mass_matrix(q), push[..., None])[..., 0], dtype=np.float64)
