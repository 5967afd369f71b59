"""Simulation of the thesis' SCARA arm on its trajectory: closed form, classical Runge–Kutta, faults of any size.

Model and integrator differ from those of the engine under study: the arm moves by its closed form and not by
Pinocchio's algorithms, and its torque is held between ticks while a fourth-order method takes several steps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.status import Event, Stage
from cdia_pin.diagnosis.thesis import ThesisEngine
from cdia_pin.effects import JointEffect, JointState
from cdia_pin.errors import ModelError
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

    def torque(self, x: JointState) -> Array:
        """Compute the torque f of the fault on all joints.

        Args:
            x: Signals of one sample, shape (n,) each.

        Returns:
            f [N·m or N], shape (n,).
        """
        return np.asarray((np.stack(self.effect.columns(x), axis=-1) * self.theta).sum(axis=-1))


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


def run(
    scenario: Scenario, engine: ThesisEngine | None = None, until: Callable[[], bool] = lambda: False
) -> ScaraRun:
    """Let the arm follow the trajectory under computed torque, with or without an engine that compensates.

    Args:
        scenario: Faults and conditions.
        engine: Monitors the run, and compensates if its settings allow it; None for no engine.
        until: Ends the run early if it returns True; called now and then.

    Returns:
        Motion, tracking errors and the output of the engine.

    Raises:
        ModelError: If the run diverges.
    """
    count = round(scenario.duration / scenario.tick) + 1
    time = np.arange(count, dtype=np.float64) * scenario.tick
    out = {
        name: np.zeros((count, 4))
        for name in ("q", "v", "q_error", "v_error", "effort", "residual", "threshold")
    }
    stages: list[Stage] = []
    q, v, _ = desired(0.0)
    if scenario.start is not None:
        q, v = scenario.start.copy(), np.zeros(4)
    tau = np.zeros(4)
    for k, t in enumerate(time.tolist()):
        q_d, v_d, a_d = desired(t)
        if engine is not None:
            status = engine.update(t, q, v, tau)
            out["residual"][k], out["threshold"][k] = status.residual, status.threshold
            stages.append(status.stage)
        wanted = a_d - STIFFNESS * (q - q_d) - DAMPING * (v - v_d)
        tau = scara.mass_matrix(q) @ wanted + scara.nonlinear_effects(q, v)
        if engine is not None:
            tau = engine.correct(tau)
        for name, value in (("q", q), ("v", v), ("q_error", q - q_d), ("v_error", v - v_d), ("effort", tau)):
            out[name][k] = value
        q, v = _advance(scenario, t, q, v, tau)
        if not np.abs(v).max() < FASTEST:
            raise ModelError(f"the simulation of the SCARA arm diverged at {t:.3g} s")
        if k % WATCHED == 0 and until():
            count = k + 1
            break
    signals: dict[str, Array] = {name: signal[:count] for name, signal in out.items()}
    return ScaraRun(
        time[:count], **signals, stages=tuple(stages), events=tuple(engine.events) if engine else ()
    )


def _advance(scenario: Scenario, t: float, q: Array, v: Array, tau: Array) -> tuple[Array, Array]:
    """Integrate over one tick by classical Runge–Kutta, with constant torque."""
    h = scenario.tick / scenario.substeps
    present = [f for f in scenario.faults if f.start - 1e-9 <= t < f.end]
    for i in range(scenario.substeps):
        at = t + i * h
        a1 = _acceleration(scenario, present, at, q, v, tau)
        q2, v2 = q + 0.5 * h * v, v + 0.5 * h * a1
        a2 = _acceleration(scenario, present, at, q2, v2, tau)
        q3, v3 = q + 0.5 * h * v2, v + 0.5 * h * a2
        a3 = _acceleration(scenario, present, at, q3, v3, tau)
        q4, v4 = q + h * v3, v + h * a3
        a4 = _acceleration(scenario, present, at, q4, v4, tau)
        q = q + h / 6 * (v + 2 * v2 + 2 * v3 + v4)
        v = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return q, v


def _acceleration(
    scenario: Scenario, present: list[Fault], t: float, q: Array, v: Array, tau: Array
) -> Array:
    push = tau - scara.nonlinear_effects(q, v)
    push -= 0.5 * scenario.unmodelled * (np.cos(5 * q) + np.sin(15 * v))
    if present:
        x = JointState(q, v, np.zeros(4), tau, np.tanh(v / scenario.sign_width), np.full(4, t))
        for fault in present:
            push = push + fault.torque(x)
    return np.asarray(np.linalg.solve(scara.mass_matrix(q), push), dtype=np.float64)
