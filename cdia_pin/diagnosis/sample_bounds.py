"""What the samples of an arm can be: limits of its file, and what its healthy runs show of its sensors.

A bound is generous, because a dropped sample is a gap, and a real fault must never look like a bad sensor: limits are
those of the URDF times a factor, and steps are compared with what the same sensors did on a healthy arm. The strongest
test needs neither: position and velocity must agree, whatever moves the arm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis import sample_rows as rows
from cdia_pin.diagnosis.healthy_part import motion
from cdia_pin.logs.log import Log
from cdia_pin.phrases import some
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

BEYOND_POSITION = (
    0.1  # [1], of a joint's range by which a position may exceed it: calibrated zeros, soft stops
)
BEYOND_LIMIT = (
    2.0  # [1], speed over the URDF's limit: limits are often those of the controller, not of the arm
)
BEYOND_EFFORT = 3.0  # [1], torque over the URDF's limit: measured torques of real logs exceed it by up to 2
BEYOND_SEEN = 10.0  # [1], speed or torque over the largest healthy one, where the URDF states no limit
ANY_POSITION = 1e4  # [rad or m], of a joint without limits: 1600 turns
ANY_SIGNAL = 1e6  # [rad/s, N·m, …], where neither a limit nor a healthy run is known
USUAL_SPEED = 3.0  # [1], over the largest healthy speed, where the limit is higher still
QUICKEST_START = (
    0.01  # [s], in which no joint reaches its largest speed; a light wrist takes 20 ms in a collision
)
MARGIN = 4.0  # [1], over the largest healthy step: faster motions, and the largest of an hour
ERROR_MARGIN = 2.0  # [1], over the largest healthy error of a position, most of which is the encoder's step
SPEED_RESOLUTION = (
    0.0025  # [1], of the largest speed: error of a velocity that is usual though a short run may not show it
)
TORQUE_RESOLUTION = 0.02  # [1], of the effort limit: step of the torque that is never suspicious
SMALL_SPEED = 0.01  # [1], of the largest speed, from which a sudden zero on all joints is suspicious
ZERO_MARGIN = 2.0  # [1], over the largest value from which all joints of a healthy arm went to zero at once
REST_SHARE = 0.005  # [1], of the largest speed: below it a joint may be at rest
DRIFT_SHARE = 0.01  # [1], of the largest speed: bias of a velocity that is never suspicious
TRAVEL_SHARE = 0.001  # [1], the same for a signal that stays the same, which is evidence by itself
HOLD_TIME = 0.02  # [s], least time for which a signal without noise must stay the same to be called frozen
HOLD_MARGIN = 3.0  # [1], over the longest time that a healthy signal stayed the same
LEAST_HOLD = 5.0  # ticks, the least of it at low rates, and for a noisy signal, which hardly repeats twice
AT_LIMIT = 0.95  # [1], of the effort limit: from there a torque may be constant because it is limited
STILL_TICKS = 100  # without a step of the position, that show how a velocity behaves at rest
NOISY_HOLD = 2.0  # ticks for which a noisy signal may stay the same by chance
MEMORY_TIME = 0.2  # [s], over which the distances of positions from where the velocity leads are summed
LARGEST_GAP = 5.0  # ticks without a good sample that filters bridge
GAP_MARGIN = 1.5  # [1], over the longest healthy time between ticks
SHORTEST_TICK = 0.1  # [1], of the usual time between ticks: an earlier sample is a doubled one
SHORTEST_SEEN = 0.5  # [1], of the shortest healthy time between ticks
OFTEN = 0.002  # [1], share of the samples; of one of a minute at 200 Hz, a burst of 0.1 s
UNSEEN_STEP = 0.1  # [1], of the largest speed: step and error of a velocity where no healthy run is known
UNSEEN_TORQUE = 0.5  # [1], of the effort limit: step of the torque where no healthy run is known

WATCHED = (
    rows.VELOCITY_STEP,
    rows.ERROR,
    rows.TORQUE_STEP,
    rows.HELD_TRAVEL,
    rows.HELD_VELOCITY,
    rows.HELD_ERROR,
    rows.HELD_TORQUE,
    rows.DRIFT,
)

# What a joint at rest does not show.
OF_MOTION = (
    rows.ACCELERATION,
    rows.VELOCITY_SLACK,
    rows.POSITION_SLACK,
    rows.ZERO_VELOCITY,
    rows.TRAVEL_BOUND,
    rows.HOLD_VELOCITY,
    rows.NOISY_AT_REST,
    rows.REST_SPEED,
    rows.DRIFT_BOUND,
)


@dataclass(frozen=True, eq=False)
class SampleBounds:
    """What the samples of an arm can be.

    Attributes:
        array: One row of `sample_rows` for each bound, shape (`BOUND_ROWS`, n).
        period: Usual time between ticks [s].
        shortest: Least time between ticks [s].
        longest: Largest time between ticks that may be bridged [s].
        speed: Largest speed of each joint, by its limit or as seen [rad/s or m/s], shape (n,).
        effort: Largest torque of each joint, by its limit or as seen [N·m or N], shape (n,); ``inf`` if unknown.
    """

    array: Array
    period: float
    shortest: float
    longest: float
    speed: Array
    effort: Array

    @classmethod
    def learned(cls, robot: RobotModel, runs: Sequence[Log]) -> SampleBounds:
        """Return the bounds of an arm with healthy runs.

        Of a joint that hardly moved in them, bounds of its motion are those without healthy runs.

        Args:
            robot: The arm.
            runs: Its healthy runs, all with velocities or all without.
        """
        gaps = np.concatenate([np.diff(run.time) for run in runs])
        period = float(np.median(gaps))
        speeds = [_speed(run) for run in runs]
        seen_speed = np.max([np.abs(v).max(axis=0) for v in speeds], axis=0)
        seen_effort = np.max([np.abs(run.effort).max(axis=0) for run in runs], axis=0)
        low = np.min([run.position.min(axis=0) for run in runs], axis=0)
        high = np.max([run.position.max(axis=0) for run in runs], axis=0)
        limits = robot.limits
        speed = _largest(limits.velocity, seen_speed, BEYOND_LIMIT)
        effort = _largest(limits.effort, seen_effort, BEYOND_EFFORT)
        # Limits may be far beyond what the arm does, and then say nothing about its sensors.
        usual = np.minimum(speed, USUAL_SPEED * np.where(seen_speed > 0, seen_speed, np.inf))
        rested = _rested(runs)  # at rest a torque steps less than in motion
        load = np.minimum(effort, np.where((seen_effort > 0) & ~rested, seen_effort, np.inf))
        step, error, torque, travel, hold_v, held_error, hold_tau, drift = _survey(
            robot.n, runs, speeds, period
        )
        still = sum((np.diff(run.position, axis=0) == 0).sum(axis=0) for run in runs)
        array = _static(robot, speed, effort, low, high)
        array[rows.ACCELERATION] = usual / QUICKEST_START
        array[rows.REST_SPEED] = REST_SHARE * usual
        array[rows.ZERO_VELOCITY] = np.maximum(SMALL_SPEED * usual, ZERO_MARGIN * _before_zeros(speeds))
        efforts = [run.effort for run in runs]
        array[rows.ZERO_TORQUE] = np.maximum(TORQUE_RESOLUTION * load, ZERO_MARGIN * _before_zeros(efforts))
        array[rows.VELOCITY_SLACK] = np.maximum(MARGIN * step, SPEED_RESOLUTION * usual)
        array[rows.POSITION_SLACK] = ERROR_MARGIN * error + SPEED_RESOLUTION * usual * period
        array[rows.TORQUE_SLACK] = MARGIN * torque + TORQUE_RESOLUTION * load
        array[rows.TRAVEL_BOUND] = (
            MARGIN * np.maximum(travel, held_error) + TRAVEL_SHARE * usual * MEMORY_TIME
        )
        array[rows.DRIFT_BOUND] = MARGIN * drift + DRIFT_SHARE * usual * MEMORY_TIME
        array[rows.HOLD_VELOCITY], array[rows.HOLD_TORQUE] = _hold(hold_v, period), _hold(hold_tau, period)
        array[rows.NOISY_AT_REST] = (still >= STILL_TICKS) & (hold_v <= NOISY_HOLD)
        assumed = cls.assumed(robot, 1.0 / period).array
        for row in OF_MOTION:
            array[row, rested] = assumed[row, rested]
        shortest = min(SHORTEST_TICK * period, SHORTEST_SEEN * float(gaps.min()))
        longest = max(LARGEST_GAP * period, GAP_MARGIN * float(gaps.max()))
        return cls(array, period, shortest, longest, speed, effort)

    def rougher(self, log: Log) -> str:
        """Return a sentence if most joints' torques often step as no healthy one does, empty if not.

        A sensor that fails is one; a log that was filtered less than the healthy runs is rougher on all joints.

        Args:
            log: A log of the arm, at the rate of the healthy runs.
        """
        beyond = np.abs(np.diff(log.effort, axis=0)) > self.array[rows.TORQUE_SLACK]
        rough = [j for j, share in zip(log.joints, beyond.mean(axis=0), strict=True) if share > OFTEN]
        if 2 * len(rough) <= len(log.joints):
            return ""
        return (
            f"{log.source}: the torque of {some(rough)} steps from sample to sample as in no healthy run: it was "
            "filtered otherwise, and looks like bad sensors; give healthy runs that were recorded as this log was"
        )

    @classmethod
    def assumed(cls, robot: RobotModel, rate: float) -> SampleBounds:
        """Return the bounds of an arm of which no healthy run is known; frozen torques are not noticed then.

        Args:
            robot: The arm.
            rate: Ticks per second [Hz].
        """
        limits, period = robot.limits, 1.0 / rate
        speed = np.where(np.isfinite(limits.velocity), limits.velocity, ANY_SIGNAL)
        array = _static(robot, speed, limits.effort, limits.lower, limits.upper)
        array[rows.VELOCITY_SLACK] = UNSEEN_STEP * speed
        array[rows.POSITION_SLACK] = UNSEEN_STEP * speed * period
        array[rows.TORQUE_SLACK] = UNSEEN_TORQUE * limits.effort
        array[rows.TRAVEL_BOUND] = array[rows.DRIFT_BOUND] = UNSEEN_STEP * speed * MEMORY_TIME
        array[rows.HOLD_VELOCITY] = max(LEAST_HOLD, HOLD_TIME / period)
        array[rows.HOLD_TORQUE] = np.inf
        return cls(array, period, SHORTEST_TICK * period, LARGEST_GAP * period, speed, limits.effort)


def _largest(limit: Array, seen: Array, beyond: float) -> Array:
    """Return the largest size of a signal of each joint, by its limit or as seen, shape (n,).

    A joint that rested or carried nothing says little of its drive: it may be asked for what other joints give.

    Args:
        limit: As the URDF states it, ``inf`` where it does not, shape (n,).
        seen: The largest in healthy runs, shape (n,).
        beyond: Factor by which the largest may be exceeded [1].
    """
    unstated = np.maximum(BEYOND_SEEN / beyond * seen, seen.max())
    most = np.maximum(np.where(np.isfinite(limit), limit, unstated), seen)
    return np.where(most > 0, most, ANY_SIGNAL)


def _static(robot: RobotModel, speed: Array, effort: Array, low: Array, high: Array) -> Array:
    """Return the bounds that hold for a sample by itself, and those of zeros and of rest; the others are infinite."""
    limits, array = robot.limits, np.full((rows.BOUND_ROWS, robot.n), np.inf)
    lower, upper = np.minimum(limits.lower, low), np.maximum(limits.upper, high)
    bounded = np.isfinite(lower) & np.isfinite(upper)
    beyond = np.where(bounded, BEYOND_POSITION * (upper - lower), 0.0)
    array[rows.LOWER] = np.where(bounded, lower - beyond, -ANY_POSITION)
    array[rows.UPPER] = np.where(bounded, upper + beyond, ANY_POSITION)
    array[rows.FASTEST] = np.minimum(BEYOND_LIMIT * speed, ANY_SIGNAL)
    array[rows.STRONGEST] = np.minimum(BEYOND_EFFORT * effort, ANY_SIGNAL)
    array[rows.ACCELERATION] = speed / QUICKEST_START
    array[rows.ZERO_VELOCITY] = SMALL_SPEED * speed
    array[rows.ZERO_TORQUE] = TORQUE_RESOLUTION * effort
    array[rows.REST_SPEED] = REST_SHARE * speed
    array[rows.SATURATED] = AT_LIMIT * robot.limits.effort
    array[rows.NOISY_AT_REST] = 0.0
    return array


def _hold(seen: Array, period: float) -> Array:
    """Return the ticks for which a signal may stay the same, from the most that was seen, shape (n,)."""
    return np.where(
        seen <= NOISY_HOLD, LEAST_HOLD, np.maximum(HOLD_MARGIN * seen, max(LEAST_HOLD, HOLD_TIME / period))
    )


def _speed(run: Log) -> Array:
    """Return the velocities of a run, differences of positions where they were not measured, shape (K, n)."""
    if run.velocity is not None:
        return run.velocity
    steps = np.diff(run.position, axis=0) / np.diff(run.time)[:, None]
    return np.vstack([steps[:1], steps])


def _rested(runs: Sequence[Log]) -> NDArray[np.bool_]:
    """Tell which joints hardly moved: they show neither how they move nor the step of their encoder, shape (n,)."""
    from cdia_pin.diagnosis.moving_residual import LEAST_MOTION

    moved = sum(motion(run).sum(axis=0) / run.rate for run in runs)
    return np.asarray(moved < LEAST_MOTION)


def _before_zeros(signals: Sequence[Array]) -> Array:
    """Return the largest value of each joint before all joints read zero at once, as coarse signals do, shape (n,).

    Args:
        signals: A signal of each run, shape (K, n) each.
    """
    before = [np.abs(x[:-1])[(x[1:] == 0.0).all(axis=1)] for x in signals]
    return np.asarray(np.max(np.vstack([*before, np.zeros((1, signals[0].shape[1]))]), axis=0))


def _survey(n: int, runs: Sequence[Log], speeds: Sequence[Array], period: float) -> Array:
    """Return the largest size of each of `WATCHED` along healthy runs, shape (R, n)."""
    from cdia_pin.diagnosis.sample_kernel import survey

    largest = np.zeros((len(WATCHED), n))
    free = np.full((rows.BOUND_ROWS, n), np.inf)
    free[rows.LOWER], free[rows.NOISY_AT_REST] = -np.inf, 0.0
    for run, speed in zip(runs, speeds, strict=True):
        state, scalars = np.zeros((rows.STATE_ROWS, n)), np.zeros(rows.SCALARS)
        scalars[rows.PREVIOUS], scalars[rows.PERIOD], scalars[rows.MEMORY] = -np.inf, period, MEMORY_TIME
        scalars[rows.LONGEST] = LARGEST_GAP * period
        scalars[rows.HAS_VELOCITY] = float(run.velocity is not None)
        t, q, v, tau = (np.ascontiguousarray(s, float) for s in (run.time, run.position, speed, run.effort))
        survey(free, state, scalars, t, q, v, tau, np.array(WATCHED), largest)
    return largest
