"""The motion of a log, smoothed without lag and thinned, so that many hypotheses can be tried."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.derivatives import uniform, zero_phase
from cdia_pin.logs.log import Log
from cdia_pin.logs.recorded_parts import recorded_parts
from cdia_pin.logs.reversals import reversals

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

CUTOFF = 8.0  # [Hz], arms move below it; drives and quantisation make noise above it
SAMPLES = 800  # [samples], enough to separate hypotheses, few enough for a hundred of them
STANDSTILL = 0.02  # [rad], a joint that covers less is held by its brake or its controller
STANDSTILL_PRISMATIC = 0.005  # [m], the same for a prismatic joint
SLOWEST = 0.02  # [rad/s or m/s], smoothing width of the velocity's sign, well below working speeds
SHORTEST = 2.0  # [s], a shorter stretch has too few reversals and accelerations
# Share of the first principal component in the joints' speeds [1], above which they move in step. Exciting motions and
# work of measured arms have at most 0.84, motions in which all joints follow one course 0.97 and more: values between
# decide alike there.
IN_STEP = 0.95


@dataclass(frozen=True)
class SmoothedMotion:
    """Smooth positions, their derivatives and efforts on a thin uniform grid.

    Attributes:
        time: Times [s], shape (N,).
        q: Positions [rad or m], shape (N, n).
        v: Velocities, derived from the positions [rad/s or m/s], shape (N, n).
        a: Accelerations, derived from the positions [rad/s² or m/s²], shape (N, n).
        effort: Efforts with the same smoothing [as logged], shape (N, n).
        moves: True for joints that move enough to be checked, shape (n,).
    """

    time: Array
    q: Array
    v: Array
    a: Array
    effort: Array
    moves: Mask

    @cached_property
    def common_course(self) -> float:
        """Share of the speeds of the joints that move that is one common course [1]; 0 if fewer than two move."""
        speed = self.v[:, self.moves]
        if speed.shape[1] < 2:
            return 0.0
        shares = np.linalg.svd(speed / speed.std(axis=0), compute_uv=False) ** 2
        return float(shares[0] / shares.sum())

    @property
    def is_in_step(self) -> bool:
        """True if all joints follow one course, so that what one of them does looks like what another does."""
        return self.common_course > IN_STEP

    @property
    def is_of_single_strokes(self) -> bool:
        """True if no joint that moves ever turns back, so that friction and offsets look like anything else."""
        return not any(reversals(v) for v in self.v[:, self.moves].T)

    def thin(self, samples: int) -> SmoothedMotion:
        """Return the motion with fewer samples.

        Args:
            samples: Approximate number of samples that are kept.

        Returns:
            Every k-th sample.
        """
        s = np.s_[:: _step(len(self.time), samples)]
        return replace(self, time=self.time[s], q=self.q[s], v=self.v[s], a=self.a[s], effort=self.effort[s])


def _step(count: int, samples: int) -> int:
    """Return the step by which about so many of a number of samples are kept."""
    return max(1, count // samples)


def motion_of(log: Log, is_prismatic: Mask, cutoff: float = CUTOFF) -> SmoothedMotion | None:
    """Smooth the longest stretch of a log without a gap.

    Args:
        log: The log.
        is_prismatic: True for prismatic joints, shape (n,).
        cutoff: Cut-off of the zero-phase filter [Hz].

    Returns:
        The motion; None if the stretch is too short.
    """
    try:
        even = uniform(longest_stretch(log))
    except LogError:  # more gaps than samples
        return None
    rate = even.rate
    cutoff = min(cutoff, 0.2 * rate)
    edge = int(rate / cutoff) + 1  # here the padding, not the arm, determines the acceleration
    if even.duration < SHORTEST or len(even.time) < 2 * edge + 30:
        return None
    kept = np.s_[edge : -edge : _step(len(even.time) - 2 * edge, SAMPLES)]
    still = np.where(is_prismatic, STANDSTILL_PRISMATIC, STANDSTILL)
    thin: list[Array] = []  # joint by joint, and copied: a view would hold the signals of a long log
    for k in range(len(still)):
        joint = np.s_[:, k : k + 1]
        whole = zero_phase(even.position[joint], cutoff, rate)
        parts, span = [whole[kept].copy()], np.full_like(whole[kept], np.ptp(whole[edge:-edge]))
        for d in (1, 2):
            parts.append(zero_phase(even.position[joint], cutoff, rate, derivative=d)[kept].copy())
        whole = zero_phase(even.effort[joint], cutoff, rate)
        thin.append(np.stack([*parts, whole[kept], span]))
    q, v, a, effort, span = np.concatenate(thin, axis=2)
    return SmoothedMotion(even.time[kept].copy(), q, v, a, effort, moves=span[0] > still)


def longest_stretch(log: Log) -> Log:
    """Find the longest part of a log between its gaps.

    Args:
        log: The log.

    Returns:
        That part; the log itself if it has no such gap.
    """
    parts = recorded_parts(log)
    if len(parts) == 1:
        return log
    longest = max(parts, key=lambda p: p.stop - p.start)
    return log.slice(longest.start, max(longest.stop, longest.start + 2))


def sign_of(v: Array) -> Array:
    """Compute the smooth sign of a velocity, tanh(v / ``SLOWEST``), as friction has it.

    Args:
        v: Velocities [rad/s or m/s], any shape.

    Returns:
        Sign [1], shape of v.
    """
    return np.tanh(v / SLOWEST)
