"""The motion behind a log: smooth, free of lag, thin enough to try many hypotheses on."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.derivatives import differentiate, uniform, zero_phase
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

CUTOFF = 8.0  # [Hz]; arms move below it, drives and quantisation ring above it
SAMPLES = 800  # as many as tell hypotheses apart, few enough for a hundred of them
STANDSTILL = 0.02  # [rad]; a joint that covers less is held by its brake or its controller
STANDSTILL_PRISMATIC = 0.005  # [m]
SLOWEST = 0.02  # [rad/s or m/s]; width of the sign of the velocity, well below working speeds
LONGEST_GAP = 0.5  # [s]; across more than this a trajectory cannot be interpolated
SHORTEST = 2.0  # [s]


@dataclass(frozen=True)
class Motion:
    """Smooth positions, their derivatives and efforts on a thin uniform grid.

    Attributes:
        time: Times [s], shape (N,).
        q: Positions [rad or m], shape (N, n).
        v: Velocities, derived from the positions, shape (N, n).
        a: Accelerations, derived from the positions, shape (N, n).
        effort: Efforts [as logged], with the same smoothing, shape (N, n).
        moves: Joints that move enough to say anything, shape (n,).
    """

    time: Array
    q: Array
    v: Array
    a: Array
    effort: Array
    moves: Mask

    def thin(self, samples: int) -> Motion:
        """Return at most about ``samples`` samples."""
        step = max(1, len(self.time) // samples)
        s = np.s_[::step]
        return replace(self, time=self.time[s], q=self.q[s], v=self.v[s], a=self.a[s], effort=self.effort[s])


def motion_of(log: Log, is_prismatic: Mask, cutoff: float = CUTOFF) -> Motion | None:
    """Smooth the longest stretch of a log without a gap; None if that is too short to say anything."""
    try:
        even = uniform(longest_stretch(log))
    except LogError:  # more gaps than samples
        return None
    rate = even.rate
    cutoff = min(cutoff, 0.2 * rate)
    edge = int(rate / cutoff) + 1  # where odd padding, not the arm, makes the acceleration
    if even.duration < SHORTEST or len(even.time) < 2 * edge + 30:
        return None
    q = zero_phase(even.position, cutoff, rate)
    v = differentiate(q, rate)
    a = differentiate(v, rate)
    effort = zero_phase(even.effort, cutoff, rate)
    inside = np.s_[edge:-edge]
    still = np.where(is_prismatic, STANDSTILL_PRISMATIC, STANDSTILL)
    motion = Motion(
        time=even.time[inside],
        q=q[inside],
        v=v[inside],
        a=a[inside],
        effort=effort[inside],
        moves=np.ptp(q[inside], axis=0) > still,
    )
    return motion.thin(SAMPLES)


def longest_stretch(log: Log) -> Log:
    """Return the longest part of a log without a gap over ``LONGEST_GAP`` (and ten periods)."""
    step = np.diff(log.time)
    cuts = np.flatnonzero(step > max(LONGEST_GAP, 10.0 / log.rate)) + 1
    if not len(cuts):
        return log
    bounds = np.concatenate([[0], cuts, [len(log.time)]])
    lengths = np.diff(bounds)
    longest = int(lengths.argmax())
    if lengths[longest] < 2:
        return log.slice(0, 2)
    return log.slice(int(bounds[longest]), int(bounds[longest + 1]))


def sign_of(v: Array) -> Array:
    """Smooth sign of a velocity, tanh(v / ``SLOWEST``) [1], as friction follows it."""
    return np.tanh(v / SLOWEST)
