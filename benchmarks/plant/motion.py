"""Motions that the plant is asked to make: seeded, within the limits, starting and ending at rest."""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

BLEND = 2.0  # [s], in which a periodic motion grows from rest, and fades at the end
MARGIN = 0.9  # share of a joint's range that a motion may use
RANGE = 2.0  # [rad], half the range used of a joint that turns further, or endlessly
START = 1.0  # [rad], how far from the middle of its range a joint may start


class Reference(NamedTuple):
    """A planned motion: position, velocity, acceleration [rad, rad/s, rad/s² or m...], each (N, n)."""

    q: Array
    v: Array
    a: Array


@dataclass(frozen=True)
class Reach:
    """What the joints may do, shape (n,) each.

    Attributes:
        lower: Smallest position [rad or m].
        upper: Largest position [rad or m].
        speed: Largest speed [rad/s or m/s].
        joints: Names of the joints.
    """

    lower: Array
    upper: Array
    speed: Array
    joints: tuple[str, ...]

    @property
    def middle(self) -> Array:
        """Middle of the range; zero for a joint without one [rad or m]."""
        both = np.isfinite(self.lower) & np.isfinite(self.upper)
        with np.errstate(invalid="ignore"):
            return np.where(both, (self.lower + self.upper) / 2, 0.0)

    @property
    def half(self) -> Array:
        """Half of the range that a motion may use [rad or m]."""
        return np.minimum(MARGIN * (self.upper - self.lower) / 2, RANGE)


Plan = Callable[[Array], Reference]  # time (N,) to the motion at these times


class Motion(ABC):
    """A kind of motion; `plan` draws one."""

    @abstractmethod
    def plan(self, reach: Reach, duration: float, rng: np.random.Generator) -> Plan:
        """Return a motion of the given duration [s] as a function of time."""


@dataclass(frozen=True)
class Fourier(Motion):
    """Sum of sines of one base frequency and its multiples, on every joint.

    Attributes:
        harmonics: Number of multiples of the base frequency.
        base: Base frequency [Hz]; drawn between 0.05 and 0.1 if None.
        speed: Largest speed as a share of what the joint may do [1].
        amplitude: Largest deviation from the centre [rad or m].
        joints: Joints that move; all if empty.
    """

    harmonics: int = 5
    base: float | None = None
    speed: float = 1.0
    amplitude: float = np.inf
    joints: tuple[str, ...] = ()

    def plan(self, reach: Reach, duration: float, rng: np.random.Generator) -> Plan:
        """Return a motion whose fastest joints reach `speed`, or the end of their range."""
        n = len(reach.joints)
        base = float(rng.uniform(0.05, 0.1)) if self.base is None else self.base
        omega = 2 * np.pi * base * np.arange(1, self.harmonics + 1)  # [rad/s], (H,)
        sine, cosine = rng.standard_normal((2, self.harmonics, n)) / np.arange(1, self.harmonics + 1)[:, None]
        centre = reach.middle + rng.uniform(-1, 1, n) * np.minimum(START, 0.5 * reach.half)
        room = np.minimum(reach.half - np.abs(centre - reach.middle), self.amplitude)
        moves = np.array([not self.joints or j in self.joints for j in reach.joints])

        def raw(t: Array) -> Reference:
            s, c = np.sin(np.outer(t, omega)), np.cos(np.outer(t, omega))
            x = s @ sine + c @ cosine
            dx = (c * omega) @ sine - (s * omega) @ cosine
            ddx = -(s * omega**2) @ sine - (c * omega**2) @ cosine
            w, dw, ddw = (e[:, None] for e in _envelope(t, duration))
            return Reference(w * x, dw * x + w * dx, ddw * x + 2 * dw * dx + w * ddx)

        trial = raw(np.arange(0.0, duration, 0.01))
        largest = np.maximum(np.abs(trial.v).max(0), 1e-12), np.maximum(np.abs(trial.q).max(0), 1e-12)
        scale = moves * np.minimum(self.speed * reach.speed / largest[0], room / largest[1])

        def at(t: Array) -> Reference:
            x, dx, ddx = raw(t)
            return Reference(centre + scale * x, scale * dx, scale * ddx)

        return at


@dataclass(frozen=True)
class PointToPoint(Motion):
    """Straight moves in joint space between drawn postures, with a rest at each.

    Attributes:
        rest: Time at rest between two moves [s].
        speed: Largest speed as a share of what the joints may do [1].
        amplitude: Largest distance of a posture from the middle of the range [rad or m].
    """

    rest: float = 0.5
    speed: float = 0.8
    amplitude: float = np.inf

    def plan(self, reach: Reach, duration: float, rng: np.random.Generator) -> Plan:
        """Return moves of quintic timing, as many as fit."""
        span = np.minimum(0.7 * reach.half, self.amplitude)
        postures = [reach.middle + rng.uniform(-1, 1, len(reach.joints)) * span]
        starts, lengths = [], []
        clock = self.rest
        while True:
            goal = reach.middle + rng.uniform(-1, 1, len(reach.joints)) * span
            # 15/8 is the ratio of largest to mean speed of a quintic move
            length = max(
                15 / 8 * float(np.max(np.abs(goal - postures[-1]) / (self.speed * reach.speed))), 0.5
            )
            if clock + length + self.rest > duration:
                break
            starts.append(clock)
            lengths.append(length)
            postures.append(goal)
            clock += length + self.rest

        def at(t: Array) -> Reference:
            q = np.tile(postures[0], (len(t), 1))
            v, a = np.zeros_like(q), np.zeros_like(q)
            for k, (start, length) in enumerate(zip(starts, lengths, strict=True)):
                step = postures[k + 1] - postures[k]
                s, ds, dds = _quintic((t - start) / length)
                q += s[:, None] * step
                v += ds[:, None] * step / length
                a += dds[:, None] * step / length**2
            return Reference(q, v, a)

        return at


@dataclass(frozen=True, repr=False)
class Given(Motion):
    """A motion that is there already, such as a designed one.

    Attributes:
        trajectory: Times (N,) [s] to positions, velocities and accelerations, (N, n) each.
        length: Its length [s]; at rest at its last posture after that.
    """

    trajectory: Callable[[Array], tuple[Array, Array, Array]]
    length: float

    def __repr__(self) -> str:
        """Return a name that says which motion it is: runs are found again by it."""
        samples = np.stack(self.trajectory(np.linspace(0.0, self.length, 500)))
        return f"Given({hashlib.sha256(samples.tobytes()).hexdigest()}, {self.length})"

    def plan(self, reach: Reach, duration: float, rng: np.random.Generator) -> Plan:
        """Return the motion itself."""

        def at(t: Array) -> Reference:
            return Reference(*self.trajectory(np.minimum(t, self.length)))

        return at


def slow(speed: float = 0.12) -> Fourier:
    """Return a motion too slow to show inertia."""
    return Fourier(speed=speed)


def small(amplitude: float = 0.1) -> Fourier:
    """Return a motion that stays near one posture."""
    return Fourier(amplitude=amplitude)


def single(joints: Sequence[str]) -> Fourier:
    """Return a motion of the named joints alone."""
    return Fourier(joints=tuple(joints))


def _quintic(s: Array) -> tuple[Array, Array, Array]:
    """Return the step 0 → 1 over s ∈ [0, 1] and its two derivatives; constant outside."""
    s = np.clip(s, 0.0, 1.0)
    return s**3 * (10 - 15 * s + 6 * s**2), 30 * s**2 * (1 - s) ** 2, 60 * s * (1 - s) * (1 - 2 * s)


def _envelope(t: Array, duration: float) -> tuple[Array, Array, Array]:
    """Return the share of a motion that is present, 0 at both ends, and its two derivatives."""
    blend = min(BLEND, duration / 3)
    up, dup, ddup = _quintic(t / blend)
    down, ddown, dddown = _quintic((duration - t) / blend)
    return (
        up * down,
        (dup * down - up * ddown) / blend,
        (ddup * down - 2 * dup * ddown + up * dddown) / blend**2,
    )
