"""Logs made in the open for tests of the parts: exact motions, and a missing torque written out in the test."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.robot import RobotModel

Array = np.ndarray
Missing = Callable[[Array, Array, Array], Array]  # f [N·m or N] of q, q̇, q̈, each (N, n)

RATE = 100.0  # [Hz]
CUTOFF = Conditioning(cutoff=8.0)  # [Hz]


@dataclass(frozen=True)
class Made:
    """A log beside the motion and the missing torque it was made of, shape (N, n) each."""

    log: Log
    q: Array
    v: Array
    a: Array
    f: Array


def motion(n: int, seed: int = 0, duration: float = 20.0, rate: float = RATE) -> tuple[Array, ...]:
    """Time, and positions, speeds and accelerations of sums of sines with their exact derivatives."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, duration, 1.0 / rate)
    w = 2 * np.pi * rng.uniform(0.1, 0.8, (4, n))
    size, phase = rng.uniform(0.15, 0.4, (4, n)), rng.uniform(0, 2 * np.pi, (4, n))
    angle = t[:, None, None] * w + phase
    q = (size * np.sin(angle)).sum(axis=1)
    v = (size * w * np.cos(angle)).sum(axis=1)
    a = -(size * w**2 * np.sin(angle)).sum(axis=1)
    return t, q, v, a


def nothing(q: Array, v: Array, a: Array) -> Array:
    """No torque is missing."""
    return np.zeros_like(q)


def make(
    robot: RobotModel,
    missing: Missing = nothing,
    *,
    seed: int = 0,
    duration: float = 20.0,
    rate: float = RATE,
    noise: float | Array = 0.0,
) -> Made:
    """Return a log of an arm that lacks f, τ = M q̈ + nle − f + noise.

    Args:
        robot: The arm.
        missing: Its missing torque.
        seed: Of motion and noise.
        duration: Length [s].
        rate: Sampling rate [Hz].
        noise: Standard deviation of white torque noise [N·m or N], or the noise itself (N, n).
    """
    t, q, v, a = motion(robot.n, seed, duration, rate)
    f = missing(q, v, a)
    effort = robot.inverse_dynamics(q, v, a) - f
    added = noise * np.random.default_rng(seed + 1).standard_normal(q.shape) if np.ndim(noise) == 0 else noise
    return Made(Log(robot.joints, t, q, effort + added, source="made"), q, v, a, f)


def with_velocity(robot: RobotModel) -> Log:
    """Return a log of 8 s with velocities and a little noise."""
    made = make(robot, duration=8.0, noise=0.2)
    return replace(made.log, velocity=made.v)


def conditioned(robot: RobotModel, made: Made):
    """Return the conditioned log."""
    return condition(made.log, robot, CUTOFF)


def autoregressive(
    coefficients: list[float], shape: tuple[int, ...], rng: np.random.Generator, sigma: float = 1.0
) -> Array:
    """Return stationary noise e_t = Σ a_k e_{t−k} + σ w_t, shape as given with time first."""
    settle, p = 200, len(coefficients)
    w = sigma * rng.standard_normal((shape[0] + settle, *shape[1:]))
    e = np.zeros_like(w)
    for t in range(len(w)):
        e[t] = w[t] + sum(a * e[t - k] for k, a in enumerate(coefficients, 1) if t >= k)
    assert p < settle
    return e[settle:]
