"""Conditioning of a log: motion, accelerations and torques that can be compared, with a record of every step.

Positions and torques pass the same zero-phase filter. Each torque that is computed from the positions passes it
again, together with the measured torque, and both are decimated to the bandwidth that is left. So both sides of
M q̈ + nle = τ + f are treated alike [Gautier1997].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.cutoff import LOWEST_CUTOFF, choose_cutoff
from cdia_pin.logs.derivatives import differentiate, uniform, zero_phase
from cdia_pin.logs.log import Log
from cdia_pin.logs.magnitudes import require_magnitudes
from cdia_pin.logs.motion import Motion, MotionRecord
from cdia_pin.logs.resolution import quantum
from cdia_pin.logs.wild_samples import without_wild_samples
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

__all__ = ["Conditioning", "Motion", "condition"]

SHORTEST = 3.0  # [s], shortest log: trimming both ends of a shorter one leaves too few samples
MOTION_OVERSAMPLING = 8.0  # [1], rate of the motion over the cut-off: nonlinear effects make harmonics
TORQUE_OVERSAMPLING = 2.2  # [1], rate of the compared torques over the cut-off: just above Nyquist's 2
HIGHEST_SHARE_GIVEN = (
    0.4  # [1], largest cut-off that a user may give, over the log's rate: below Nyquist's 0.5
)
DROWNED = 3.0  # [1], power of an acceleration over that of its noise below which it is set to zero
# [Hz], cut-off of a motion that holds no steps of the encoder any more. A motion that is filtered no more than the one
# that is compared holds them: rounded again, it shows half or a third of the error.
STEPLESS = LOWEST_CUTOFF / 4
STRETCH = 1.0  # [s], length of the parts of a log of which the one with the largest acceleration counts


@dataclass(frozen=True)
class Conditioning:
    """Settings of the conditioning.

    Attributes:
        cutoff: Cut-off of the zero-phase filter [Hz]; chosen from the log if None.
        trim: Length cut from both ends, where the filter lacks neighbours [periods of the cut-off].
    """

    cutoff: float | None = None
    trim: float = 2.0


def condition(log: Log, robot: RobotModel, settings: Conditioning | None = None) -> Motion:
    """Condition a log.

    Velocities are derived from the positions, even if the log has velocities: a drive filters its velocity with a
    lag that is not recorded.

    Args:
        log: The measured log.
        robot: Its robot, which is needed to choose the cut-off.
        settings: Cut-off and trimming; if omitted, the cut-off is chosen from the log.

    Returns:
        Motion and torque on a uniform grid.

    Raises:
        LogError: If the log is too short, too many of its samples are wild, or the cut-off is too high for its rate.
    """
    settings = settings or Conditioning()
    if log.joints != robot.joints:
        raise LogError(
            f"{log.source}: its joints are {', '.join(log.joints)}, those of '{robot.name}' {', '.join(robot.joints)}"
        )
    if log.duration < SHORTEST:
        raise LogError(
            f"{log.source}: {log.duration:.2g} s is too short to compare, at least {SHORTEST:g} s are needed"
        )
    log = without_wild_samples(log)
    require_magnitudes(log)
    even = uniform(log)
    rate = (len(even.time) - 1) / even.duration
    cutoff = choose_cutoff(even, robot) if settings.cutoff is None else settings.cutoff
    if not 0 < cutoff < HIGHEST_SHARE_GIVEN * rate:
        raise LogError(
            f"{log.source}: a cut-off of {cutoff:g} Hz is too high for a log of {rate:.4g} Hz; "
            f"it must be above 0 and below {HIGHEST_SHARE_GIVEN:g} of the rate"
        )
    q = zero_phase(even.position, cutoff, rate)
    v = differentiate(q, rate)
    a = differentiate(v, rate)
    effort = zero_phase(even.effort, cutoff, rate)
    speed_noise = _speed_noise(even.position, q, rate, cutoff)
    acceleration_noise = np.maximum(
        # white noise of a filtered position: noise of its acceleration from noise of its speed
        speed_noise * 2 * np.pi * cutoff * np.sqrt(3 / 5),
        _rounding(even.position, rate, cutoff),
    )
    # else inertias would be fitted to the noise in the acceleration of a joint that hardly accelerates
    drowned = _busiest(a, rate) < DROWNED * acceleration_noise**2
    a[:, drowned] = 0.0
    every = max(1, int(rate / (MOTION_OVERSAMPLING * cutoff)))
    kept = np.s_[::every]
    again = max(1, int(rate / every / (TORQUE_OVERSAMPLING * cutoff)))
    return Motion(
        joints=log.joints,
        time=even.time[kept],
        q=q[kept],
        v=v[kept],
        a=a[kept],
        effort=effort[kept],
        rate=rate / every,
        cutoff=cutoff,
        decimation=again,
        speed_noise=speed_noise,
        acceleration_noise=acceleration_noise,
        effort_step=np.array([_effort_step(of_joint) for of_joint in log.effort.T]),
        record=MotionRecord(
            cutoff=cutoff,
            trim=settings.trim,
            source=log.source,
            condition=log.condition,
            sha256=log.sha256,
            log_rate=rate,
            motion_rate=rate / every,
            compared_rate=rate / every / again,
            velocity="derived from position",
            acceleration_drowned=[j for j, lost in zip(log.joints, drowned, strict=True) if lost],
            notes=list(even.notes),
        ),
        # drives report it in whole degrees
        temperature=None if even.temperature is None else zero_phase(even.temperature, cutoff, rate)[kept],
        torque_side=log.torque_side,
        effort_tolerance=log.effort_tolerance,
    )


def _effort_step(effort: Array) -> float:
    """Return the step of an effort [N·m or N].

    An effort that never changes shows no step. The step may then be as large as the effort itself.
    """
    return quantum(effort) if np.ptp(effort) else float(abs(effort[0]))


def _busiest(a: Array, rate: float) -> Array:
    """Return the power of each acceleration in the part of the log where it is largest [(rad/s²)²], shape (n,)."""
    count = max(1, min(len(a), int(len(a) / (STRETCH * rate))))
    return np.asarray(np.max([np.mean(part**2, axis=0) for part in np.array_split(a, count)], axis=0))


def _speed_noise(raw: Array, smooth: Array, rate: float, cutoff: float) -> Array:
    """Estimate the standard deviation of the filtered speed [rad/s] from the noise that the filter removed, (n,)."""
    white = np.std(raw - smooth, axis=0) / np.sqrt(max(1.0 - 2 * cutoff / rate, 0.1))
    return np.asarray(white * 2 * np.pi * cutoff * np.sqrt(2 * cutoff / rate / 3))


def _rounding(position: Array, rate: float, cutoff: float) -> Array:
    """Estimate the RMS acceleration that rounding of the positions leaves in the band [rad/s²], shape (n,).

    It is 0 for positions that are not rounded. Rounding noise is not white where a joint moves evenly, and it beats
    where the steps of the encoder meet the samples. So a much smoother motion is rounded once more.
    """
    step = np.array([quantum(of_joint) for of_joint in position.T])
    if not step.any():
        return step
    safe, smooth = np.where(step > 0, step, 1.0), zero_phase(position, min(STEPLESS, cutoff), rate)
    error = np.where(step > 0, np.round(smooth / safe) * safe - smooth, 0.0)
    again = differentiate(differentiate(zero_phase(error, cutoff, rate), rate), rate)
    return np.asarray(np.sqrt(np.mean(again**2, axis=0)))
