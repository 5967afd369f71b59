"""Motions that hide what they should show: one speed only, one direction, no more than a plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from benchmarks.plant.arm import Arm
from benchmarks.plant.motion import Fourier, Motion, Plan, Reach, Reference

Array = NDArray[np.float64]

SHARP = 20.0  # [1], how soon after a reversal a joint has its speed again; larger is sooner
PARALLEL = 0.99  # [1], cosine between axes that count as parallel
GRID = 2e-3  # [s]


@dataclass(frozen=True)
class SingleSpeed(Motion):
    """Every joint goes to and fro at one speed of its own.

    Attributes:
        speed: Of each joint as a share of what it may do [1].
        leg: Time from one reversal to the next, drawn for each joint between these [s].
    """

    speed: float = 0.2
    leg: tuple[float, float] = (1.5, 4.0)

    def plan(self, reach: Reach, duration: float, rng: np.random.Generator) -> Plan:
        """Return a motion that begins and ends at rest."""
        legs = np.maximum(np.round(duration / rng.uniform(*self.leg, len(reach.joints))), 1.0)
        speed = np.minimum(self.speed * reach.speed, 1.6 * reach.half * legs / duration)
        t = np.arange(0.0, duration + GRID, GRID)[:, None]
        rest = np.minimum(t, duration - t) / (0.1 * duration / legs.max())
        v = speed * np.tanh(SHARP * np.sin(np.pi * legs * t / duration)) * np.clip(rest, 0.0, 1.0) ** 2
        path = CubicSpline(t[:, 0], v)
        travelled = path.antiderivative()
        middle = (travelled(t[:, 0]).max(axis=0) + travelled(t[:, 0]).min(axis=0)) / 2
        start = reach.middle - middle

        def at(time: Array) -> Reference:
            return Reference(start + travelled(time), path(time), path(time, 1))

        return at


@dataclass(frozen=True)
class OneWay(Motion):
    """Every joint goes one way at one speed of its own, but for the beginning and the end.

    Attributes:
        speed: Of each joint as a share of what it may do [1], less where its range is too short for it.
        ramp: Time from rest to that speed [s].
    """

    speed: float = 0.3
    ramp: float = 1.0

    def plan(self, reach: Reach, duration: float, rng: np.random.Generator) -> Plan:
        """Return the motion, each joint in a direction that is drawn."""
        t = np.arange(0.0, duration + GRID, GRID)
        share = np.clip(np.minimum(t, duration - t) / self.ramp, 0.0, 1.0)
        path = CubicSpline(t, share**2 * (3 - 2 * share))
        travelled = path.antiderivative()
        whole = float(travelled(duration))
        speed = np.minimum(self.speed * reach.speed, 1.8 * reach.half / whole) * rng.choice(
            [-1, 1], len(reach.joints)
        )

        def at(time: Array) -> Reference:
            parts = (travelled(time) - whole / 2, path(time), path(time, 1))
            q, v, a = (np.multiply.outer(x, speed) for x in parts)
            return Reference(reach.middle + q, v, a)

        return at


@dataclass(frozen=True)
class Planar(Motion):
    """Some joints move, the others rest in the middle of their range.

    Attributes:
        joints: Joints that move.
    """

    joints: tuple[str, ...]

    def plan(self, reach: Reach, duration: float, rng: np.random.Generator) -> Plan:
        """Return a Fourier motion of the joints."""
        moving = Fourier(joints=self.joints).plan(reach, duration, rng)
        rest = np.array([j not in self.joints for j in reach.joints])

        def at(time: Array) -> Reference:
            q, v, a = moving(time)
            return Reference(np.where(rest, reach.middle, q), v, a)

        return at


def planar(arm: Arm, middle: Array) -> Planar:
    """Return a motion in a vertical plane.

    Args:
        arm: The arm.
        middle: Where the other joints rest [rad or m], shape (n,).
    """
    arm.inverse_dynamics(middle, *np.zeros((2, arm.n)))  # places the bodies
    axes = np.array([arm.data.xaxis[arm.model.joint(j).id] for j in arm.joints])
    level = (np.abs(axes[:, 2]) < 1 - PARALLEL) & ~arm.is_prismatic
    together = (np.abs(axes @ axes.T) > PARALLEL) & level & level[:, None]
    group = max(together, key=np.sum)
    return Planar(tuple(j for j, member in zip(arm.joints, group, strict=True) if member))
