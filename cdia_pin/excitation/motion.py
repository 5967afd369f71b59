"""Candidate motions: finite Fourier series, a fast one and then a slow one, at rest at both ends [Swevers1997].

A motion is drawn as coefficients, which are scaled to a trajectory. Positions, speeds and accelerations are therefore
within their limits by construction.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.dynamics import FourierTrajectory, Reference
from cdia_pin.excitation.limits import MotionLimits

Array = NDArray[np.float64]

RAMP = 2.0  # [s]; a part grows from rest and fades to it within this time, or a third of the part
SCALING_GRID = 0.02  # [s] between the times at which the largest position, speed and acceleration are found
SAFE = 0.995  # share of the limits [1], for what lies between those times
VARIED = 0.4  # share of the joints that a variation changes [1]; small steps improve the best motion
# Share of the half range [1] that each side of the centre keeps, so that every joint can move.
NARROWEST = 0.3


@dataclass(frozen=True)
class Part:
    """One part of a motion.

    Attributes:
        share: Share of the whole duration [1].
        base: Lowest frequency [Hz], or the inverse of the part's length where that is higher.
        harmonics: Number of sines and of cosines [1].
        speed: Smallest and largest share of the speed limit of a joint [1].
    """

    share: float
    base: float
    harmonics: int
    speed: tuple[float, float]


# Fast, for inertia and effects that grow with speed; slow, for dry friction and effects of the position.
PARTS = (Part(0.65, 0.08, 8, (0.4, 1.0)), Part(0.35, 0.0, 3, (0.03, 0.5)))


@dataclass(frozen=True, repr=False)
class Chain:
    """Trajectories one after another. Each starts at rest, where the one before ended.

    Attributes:
        parts: The trajectories.
    """

    parts: tuple[FourierTrajectory, ...]

    def __repr__(self) -> str:
        return f"Chain({len(self.parts)} parts, {self.duration:g} s)"

    @property
    def duration(self) -> float:
        """Length of the motion [s]."""
        return sum(p.duration for p in self.parts)

    def __call__(self, t: ArrayLike) -> Reference:
        """Return the motion at some times.

        Args:
            t: One time [s], or times, shape (N,).

        Returns:
            Position, velocity and acceleration, shape (n,) or (N, n) each.
        """
        time = np.atleast_1d(np.asarray(t, float))
        ends = np.cumsum([p.duration for p in self.parts])
        which = np.minimum(np.searchsorted(ends, time, side="right"), len(self.parts) - 1)
        out = Reference(*(np.empty((len(time), len(self.parts[0].centre))) for _ in range(3)))
        for k, part in enumerate(self.parts):
            here = which == k
            values = part(time[here] - (ends[k] - part.duration))
            for whole, piece in zip(out, values, strict=True):
                whole[here] = piece
        return Reference(*(r[0] for r in out)) if np.ndim(t) == 0 else out


@dataclass(frozen=True, eq=False, repr=False)
class Draw:
    """Coefficients of a motion, before it is scaled into its limits.

    Attributes:
        centre: Posture at both ends, around which the arm moves [rad or m], shape (n,).
        waves: Coefficients of sines and cosines of each part [1], shape (2, H, n).
        speed: Share of each joint's speed limit in each part [1], shape (P, n).
    """

    centre: Array
    waves: tuple[Array, ...]
    speed: Array

    def __repr__(self) -> str:
        return f"Draw({len(self.waves)} parts, {len(self.centre)} joints)"

    @classmethod
    def random(cls, centre: Array, rng: np.random.Generator) -> Draw:
        """Draw a motion around a posture. How fast the harmonics fall with their order is drawn too.

        Args:
            centre: The posture [rad or m], shape (n,).
            rng: Source of randomness.
        """
        n = len(centre)
        waves = []
        for part in PARTS:
            order = np.arange(1, part.harmonics + 1)[:, None]
            waves.append(rng.standard_normal((2, part.harmonics, n)) / order ** rng.uniform(0.0, 1.5))
        lowest, highest = np.log([part.speed for part in PARTS]).T[:, :, None]
        return cls(centre, tuple(waves), np.exp(rng.uniform(lowest, highest, (len(PARTS), n))))

    def varied(self, step: float, limits: MotionLimits, rng: np.random.Generator) -> Draw:
        """Return a motion that differs on some joints.

        Args:
            step: Size of the variation [1]; at 1 it is as large as another draw.
            limits: Limits of the motion.
            rng: Source of randomness.
        """
        n = len(self.centre)
        some = rng.random(n) < max(VARIED, 1.0 / n)
        some[rng.integers(n)] = True

        def noise(shape: int | tuple[int, ...]) -> Array:
            return np.asarray(step * some * rng.standard_normal(shape))

        centre = self.centre + 0.5 * limits.half * noise(n)
        waves = tuple(w + w.std(axis=(0, 1)) * noise(w.shape) for w in self.waves)
        lowest, highest = np.array([part.speed for part in PARTS]).T[:, :, None]
        speed = np.clip(self.speed * np.exp(noise(self.speed.shape)), lowest, highest)
        return Draw(within_room(centre, limits), waves, speed)

    def smaller(self, factor: float) -> Draw:
        """Return the same motion with smaller deviations from the posture.

        Args:
            factor: Factor of all deviations [1].
        """
        return replace(self, speed=self.speed * factor)

    def trajectory(self, duration: float, limits: MotionLimits) -> Chain:
        """Scale the motion to the limits of position, speed and acceleration.

        Args:
            duration: Length [s].
            limits: Limits of the motion.
        """
        room = np.minimum(self.centre - limits.lower, limits.upper - self.centre)
        parts = []
        for part, (sine, cosine), speed in zip(PARTS, self.waves, self.speed, strict=True):
            length = duration * part.share
            base = max(part.base, 1.0 / length)
            ramp = min(RAMP, length / 3)
            trial = FourierTrajectory(length, base, np.zeros_like(room), sine, cosine, ramp)
            q, v, a = (np.abs(x).max(axis=0) for x in trial(np.arange(0.0, length, SCALING_GRID)))
            most = np.minimum(np.minimum(room / q, limits.velocity / v), limits.acceleration / a)
            scale = SAFE * speed * most
            parts.append(FourierTrajectory(length, base, self.centre, scale * sine, scale * cosine, ramp))
        return Chain(tuple(parts))


def within_room(centre: Array, limits: MotionLimits) -> Array:
    """Return the nearest posture that leaves a part of the range on each side.

    Args:
        centre: Posture [rad or m], shape (n,).
        limits: Limits of the motion.

    Returns:
        Posture [rad or m], shape (n,).
    """
    reach = (1.0 - NARROWEST) * limits.half
    return np.clip(centre, limits.middle - reach, limits.middle + reach)
