r"""Desired motions of an arm.

Exciting motions are finite Fourier series, which are smooth, periodic and rich [Swevers1997]:

.. math:: q_j(t) = c_j + w(t) \sum_{k=1}^{H} a_{kj} \sin(k \omega t) + b_{kj} \cos(k \omega t)

with an envelope w that starts and ends at rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.errors import RobotError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

RAMP = 2.0  # [s], longest time of the envelope's rise from rest, and of its fall
WIDEST = 2.0  # [rad], largest half range of a joint: cables of real arms do not allow many turns
LONGEST_SLIDE = 0.3  # [m], the same for a prismatic joint
FASTEST = 3.0  # [rad/s], largest speed of a joint, whatever its limit: a safe speed for most arms
FASTEST_SLIDE = 0.5  # [m/s], the same for a prismatic joint
SHORTEST, LONGEST = 0.01, 1e5  # [s], of an exciting motion: a hundredth of a second to a day
GRID = 0.002  # [s], step of the times at which the largest speed and position are evaluated
SAFE = 0.999  # [1], factor that covers larger values between the times of that grid


class Reference(NamedTuple):
    """A desired motion: one sample, shape (n,), or a trajectory, shape (N, n).

    Attributes:
        q: Positions [rad or m].
        v: Velocities [rad/s or m/s].
        a: Accelerations [rad/s² or m/s²].
    """

    q: Array
    v: Array
    a: Array

    def __repr__(self) -> str:
        return f"Reference(q, v, a of shape {self.q.shape})"


class Trajectory(Protocol):
    """A desired motion as a function of time."""

    @property
    def duration(self) -> float:
        """Length of the motion [s]."""
        ...

    def __call__(self, t: ArrayLike) -> Reference:
        """Evaluate the motion.

        Args:
            t: Time [s], scalar or shape (N,).

        Returns:
            Positions, velocities and accelerations, shape (n,) or (N, n).
        """
        ...


@dataclass(frozen=True, eq=False, repr=False)
class FourierTrajectory:
    """A sum of sines of one base frequency and its multiples, at rest at both ends.

    Attributes:
        duration: Length of the motion [s]; at rest before and after.
        base: Base frequency [Hz].
        centre: Posture around which it moves, and at which it rests [rad or m], shape (n,).
        sine: Amplitudes a of the sines [rad or m], shape (H, n).
        cosine: Amplitudes b of the cosines [rad or m], shape (H, n).
        ramp: Time of the envelope's rise from rest, and of its fall [s].
    """

    duration: float
    base: float
    centre: Array
    sine: Array
    cosine: Array
    ramp: float

    def __repr__(self) -> str:
        harmonics, joints = self.sine.shape
        return f"FourierTrajectory({joints} joints, {self.duration:g} s, {harmonics} harmonics of {self.base:g} Hz)"

    def __call__(self, t: ArrayLike) -> Reference:
        """Evaluate the motion.

        Args:
            t: Time [s], scalar or shape (N,).

        Returns:
            Positions, velocities and accelerations, shape (n,) or (N, n).
        """
        time = np.atleast_1d(np.asarray(t, float))
        omega = 2 * np.pi * self.base * np.arange(1, len(self.sine) + 1)  # [rad/s], (H,)
        s, c = np.sin(np.outer(time, omega)), np.cos(np.outer(time, omega))
        x = s @ self.sine + c @ self.cosine
        dx = (c * omega) @ self.sine - (s * omega) @ self.cosine
        ddx = -(s * omega**2) @ self.sine - (c * omega**2) @ self.cosine
        w, dw, ddw = (e[:, None] for e in _envelope(time, self.duration, self.ramp))
        out = Reference(self.centre + w * x, dw * x + w * dx, ddw * x + 2 * dw * dx + w * ddx)
        return Reference(*(r[0] for r in out)) if np.ndim(t) == 0 else out


@dataclass(frozen=True, eq=False)
class Repeated:
    """Endless repetition of a motion that starts and ends at rest in one posture.

    Attributes:
        motion: The motion that is repeated.
    """

    motion: Trajectory

    @property
    def duration(self) -> float:
        """Length of the motion that is repeated [s]."""
        return self.motion.duration

    def __call__(self, t: ArrayLike) -> Reference:
        """Evaluate the motion.

        Args:
            t: Time [s], scalar or shape (N,); beyond the duration the motion starts again.

        Returns:
            Positions, velocities and accelerations, shape (n,) or (N, n).
        """
        return self.motion(np.mod(t, self.motion.duration))


def exciting_trajectory(
    robot: RobotModel,
    rng: np.random.Generator,
    *,
    duration: float = 20.0,
    speed: float = 0.6,
    reach: float = 0.8,
    harmonics: int = 5,
    base: float = 0.1,
) -> FourierTrajectory:
    """Draw a motion within the robot's position and velocity limits.

    Each joint reaches its largest speed or the edge of its range, whichever comes first. Joints without limits
    stay within 2 rad of zero, or 0.3 m, and every joint below 3 rad/s, or 0.5 m/s. Collisions and the efforts of the
    motion are *not* checked.

    Args:
        robot: The arm.
        rng: Source of the amplitudes.
        duration: Length [s].
        speed: Largest speed, as a share of the joint's limit [1]; zero gives an arm at rest.
        reach: Largest distance from the middle of the range, as a share of half the range [1].
        harmonics: Number of sines [1].
        base: Frequency of the slowest sine [Hz].

    Returns:
        The motion, at rest at both ends.

    Raises:
        RobotError: If a setting is out of its range.
    """
    if not SHORTEST <= duration <= LONGEST:
        raise RobotError(
            f"an exciting motion needs a duration of {SHORTEST:g} to {LONGEST:g} s, given {duration:g} s"
        )
    if not (duration > 0 and base > 0 and harmonics >= 1 and 0 <= speed <= 1 and 0 < reach <= 1):
        raise RobotError(
            "an exciting motion needs duration > 0 s, base > 0 Hz, harmonics ≥ 1, 0 ≤ speed ≤ 1 and "
            f"0 < reach ≤ 1, given {duration}, {base}, {harmonics}, {speed}, {reach}"
        )
    middle, half = _range(robot)
    fastest = speed * np.minimum(robot.limits.velocity, np.where(robot.is_prismatic, FASTEST_SLIDE, FASTEST))
    order = np.arange(1, harmonics + 1)[:, None]
    sine, cosine = rng.standard_normal((2, harmonics, robot.n)) / order
    ramp = min(RAMP, duration / 3)
    still = np.zeros(robot.n)
    trial = FourierTrajectory(duration, base, still, sine, cosine, ramp)(
        np.arange(0.0, duration + GRID, GRID)
    )
    scale = SAFE * np.minimum(reach * half / np.abs(trial.q).max(0), fastest / np.abs(trial.v).max(0))
    room = reach * half - scale * np.abs(trial.q).max(0)
    centre = middle + rng.uniform(-0.5, 0.5, robot.n) * room
    return FourierTrajectory(duration, base, centre, scale * sine, scale * cosine, ramp)


def _range(robot: RobotModel) -> tuple[Array, Array]:
    """Return the middle and half of the range that a motion may use [rad or m], shape (n,) each."""
    lower, upper = robot.limits.lower, robot.limits.upper
    most = np.where(robot.is_prismatic, LONGEST_SLIDE, WIDEST)
    both = np.isfinite(lower) & np.isfinite(upper)
    with np.errstate(invalid="ignore"):  # inf − inf, where np.where takes the other value
        middle = np.where(both, (lower + upper) / 2, np.clip(0.0, lower + most, upper - most))
    return middle, np.minimum(np.minimum(upper - middle, middle - lower), most)


def _envelope(t: Array, duration: float, ramp: float) -> tuple[Array, Array, Array]:
    """Return the envelope w, 0 at both ends, and its two derivatives [1, 1/s, 1/s²], shape (N,) each."""
    up, dup, ddup = _quintic(t / ramp)
    down, ddown, dddown = _quintic((duration - t) / ramp)
    return (
        up * down,
        (dup * down - up * ddown) / ramp,
        (ddup * down - 2 * dup * ddown + up * dddown) / ramp**2,
    )


def _quintic(s: Array) -> tuple[Array, Array, Array]:
    """Return a smooth step from 0 to 1 over s ∈ [0, 1], constant outside, and its two derivatives."""
    s = np.clip(s, 0.0, 1.0)
    return s**3 * (10 - 15 * s + 6 * s**2), 30 * s**2 * (1 - s) ** 2, 60 * s * (1 - s) * (1 - 2 * s)
