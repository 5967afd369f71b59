"""The thesis' SCARA arm on its trajectory: closed form, classical Runge–Kutta, faults of any size.

Neither model nor integrator are those of the engine under study: the arm moves by its closed form instead of
Pinocchio's, and its torque is held between ticks while a fourth-order method takes several steps.
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
STIFFNESS = np.array([30.0, 60.0, 90.0, 60.0])  # K_p [1/s²]
DAMPING = np.array([10.0, 25.0, 45.0, 25.0])  # K_v [1/s]
PRINTED_START = np.pi * np.array([1 / 2, -2 / 3, -1 / 2, -0.1 / np.pi])  # [rad, rad, rad, m]
FASTEST = 1e4  # [rad/s or m/s], beyond which a run has diverged


@dataclass(frozen=True, eq=False)
class Fault:
    """A known effect on all joints at once, between two times.

    Attributes:
        effect: One of its type; its joint does not matter.
        theta: Parameters, one row per joint, (n, p).
        start: When it begins [s].
        end: When it is gone [s].
    """

    effect: JointEffect
    theta: Array
    start: float
    end: float = np.inf

    def torque(self, x: JointState) -> Array:
        """Return f [N·m or N] of all joints, for signals of shape (n,)."""
        return (np.stack(self.effect.columns(x), axis=-1) * self.theta).sum(axis=-1)


@dataclass(frozen=True, eq=False)
class Scenario:
    """What happens to the arm.

    Attributes:
        faults: What breaks, and when.
        unmodelled: Size of η = size · ½(cos 5q + sin 15q̇) [N·m or N], shape (4,); always there.
        start: Positions at the beginning [rad, rad, rad, m]; on the trajectory, in motion, if None.
        duration: Length [s].
        tick: Time between samples, over which the torque is held [s].
        substeps: Runge–Kutta steps per tick.
        sign_width: Speed below which the plant's sgn q̇ is smoothed [rad/s or m/s].
    """

    faults: tuple[Fault, ...]
    unmodelled: Array
    start: Array | None = None
    duration: float = 10.0
    tick: float = 1e-3
    substeps: int = 1
    sign_width: float = 0.01

    @property
    def healthy(self) -> Scenario:
        """The same without faults."""
        return replace(self, faults=())


@dataclass(frozen=True, eq=False)
class Run:
    """What happened, (K,) samples.

    Attributes:
        time: [s], shape (K,).
        q: Positions [rad or m], shape (K, 4).
        v: Velocities [rad/s or m/s], shape (K, 4).
        q_error: q − q_d [rad or m], shape (K, 4).
        v_error: q̇ − q̇_d [rad/s or m/s], shape (K, 4).
        effort: Torque from each sample on [N·m or N], shape (K, 4).
        residual: Velocity estimation error of the observer [rad/s or m/s], shape (K, 4); zero without engine.
        threshold: Its threshold, same unit, shape (K, 4).
        stages: Gravest stage at each sample.
        events: What the engine said.
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

    def tracking(self, start: float, end: float = np.inf) -> Array:
        """Return the RMS of the position error between two times [rad or m], shape (4,)."""
        kept = (self.time >= start) & (self.time <= end)
        rms: Array = np.sqrt(np.mean(self.q_error[kept] ** 2, axis=0, dtype=np.float64))
        return rms


def desired(t: float) -> tuple[Array, Array, Array]:
    """Return q_d, q̇_d, q̈_d of the appendix [rad or m, per s, per s²], each (4,)."""
    s, c = np.sin(FREQUENCY * t), np.cos(FREQUENCY * t)
    return AMPLITUDE * s, AMPLITUDE * FREQUENCY * c, -AMPLITUDE * FREQUENCY**2 * s


def run(
    scenario: Scenario, engine: ThesisEngine | None = None, until: Callable[[], bool] = lambda: False
) -> Run:
    """Let the arm follow the trajectory under computed torque, corrected by an engine if there is one.

    Args:
        scenario: What happens.
        engine: Watches, and corrects if its settings say so.
        until: Ends the run early where true; asked now and then.

    Raises:
        ModelError: If the arm runs away.
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
            raise ModelError(f"the SCARA arm ran away at {t:.3g} s")
        if k % 50 == 0 and until():
            count = k + 1
            break
    signals: dict[str, Array] = {name: signal[:count] for name, signal in out.items()}
    return Run(time[:count], **signals, stages=tuple(stages), events=tuple(engine.events) if engine else ())


def _advance(scenario: Scenario, t: float, q: Array, v: Array, tau: Array) -> tuple[Array, Array]:
    """Advance over a tick by classical Runge–Kutta, the torque held."""
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
