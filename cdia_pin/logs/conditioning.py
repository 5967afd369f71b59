"""Conditioning of a log: motion, accelerations and torques that can be compared, with a record of every step.

Positions and torques pass the same zero-phase filter, of the motion. Each torque that is computed from the positions
and the measured torque pass another, of the comparison, and both are decimated to the bandwidth that is left. So both
sides of M q̈ + nle = τ + f are treated alike [Gautier1997]. The filter of the motion is wider: it blurs the step of the
arm's friction at a reversal, not the one that is computed, and what is beyond the comparison's cut-off does not count.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.cutoff import LOWEST_CUTOFF, choose_cutoff
from cdia_pin.logs.derivatives import uniform
from cdia_pin.logs.filtered_part import Filter, FilteredPart, mean
from cdia_pin.logs.held_stretch import without_idle_end
from cdia_pin.logs.log import Log
from cdia_pin.logs.magnitudes import require_magnitudes
from cdia_pin.logs.motion import KERNEL, Motion, MotionRecord
from cdia_pin.logs.recorded_parts import common, on_grid, recorded_parts
from cdia_pin.logs.resolution import quantum
from cdia_pin.logs.stretches import blocks, stretches
from cdia_pin.logs.wild_samples import without_wild_samples
from cdia_pin.phrases import counted
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

__all__ = ["Conditioning", "Motion", "condition"]

# [periods of the cut-off], shortest part between two gaps: the filter's response must fit into it
SHORTEST_PART = KERNEL
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


@dataclass(frozen=True)
class Conditioning:
    """Settings of the conditioning.

    Attributes:
        cutoff: Cut-off of the compared torques [Hz]; chosen from the log if None.
        trim: Length cut from both ends, where the filter lacks neighbours [periods of the cut-off].
        most: Largest number of compared samples [1]. Of a longer log stretches are looked at, which are spread evenly
            over it; all of it if None.
        motion_band: Cut-off of the motion over that of the compared torques [1]. With 1 Coulomb friction comes out up
            to 6 % too large and viscous friction as much too small, with 1.7 up to 0.4 %; a wider band makes speeds
            noisier (docs/results-blurred-steps.md).
    """

    cutoff: float | None = None
    trim: float = 2.0
    most: int | None = None
    motion_band: float = 1.7


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
    log = without_idle_end(without_wild_samples(log))
    if log.duration < SHORTEST:
        raise LogError(
            f"{log.source}: {log.duration:.3g} s is too short to compare, at least {SHORTEST:g} s are needed"
        )
    require_magnitudes(log)
    even = uniform(log)
    rate = (len(even.time) - 1) / even.duration
    recorded = on_grid(recorded_parts(log), log, even)
    if settings.cutoff is None:
        longest = max(recorded, key=lambda part: part.stop - part.start)
        cutoff = choose_cutoff(even.slice(longest.start, longest.stop), robot)
    else:
        cutoff = settings.cutoff
    if not settings.motion_band >= 1:
        raise LogError(
            "the filter of the motion must be as wide as that of the compared torques, "
            f"motion_band={settings.motion_band:g}"
        )
    if not 0 < cutoff < HIGHEST_SHARE_GIVEN * rate:
        raise LogError(
            f"{log.source}: a cut-off of {cutoff:g} Hz is too high for a log of {rate:.4g} Hz; "
            f"it must be above 0 and below {HIGHEST_SHARE_GIVEN:g} of the rate"
        )
    if cutoff * even.duration < 1.0:
        raise LogError(
            f"{log.source}: a cut-off of {cutoff:g} Hz is too low for a log of {even.duration:.4g} s, which must hold "
            "a period of it"
        )
    every = max(1, int(rate / (MOTION_OVERSAMPLING * cutoff)))
    again = max(1, int(rate / every / (TORQUE_OVERSAMPLING * cutoff)))
    most = None if settings.most is None else settings.most * every * again
    looked_at = stretches(len(even.time), most, every)
    shortest = int(np.ceil(max(SHORTEST_PART, 2 * settings.trim + 1) / cutoff * rate))
    between = common(looked_at, recorded, shortest if len(recorded) > 1 else 0)
    if not between:
        raise LogError(
            f"{log.source}: no part of it between two gaps is {shortest / rate:.2g} s long; record it without gaps"
        )
    parts, notes = [part for part, _ in between], list(even.notes)
    lengths = () if len(parts) == 1 else tuple(len(even.time[part][::every]) for part in parts)
    if len(looked_at) > 1:
        share = sum(part.stop - part.start for part in parts) / len(even.time)
        notes.append(
            f"looked at in {len(parts)} stretches spread evenly over it, {100 * share:.2g} % of the log"
        )
    if len(recorded) > 1:
        notes.append(_said_of_gaps(log, len({other.start for _, other in between})))
    raw_effort = _joined(log.effort[p] for p in parts) if len(looked_at) > 1 else log.effort
    steps = np.array([quantum(of_joint) for of_joint in _joined(even.position[p] for p in parts).T])
    wide = min(settings.motion_band * cutoff, HIGHEST_SHARE_GIVEN * rate)
    by = Filter(cutoff, wide, rate, every, min(STEPLESS, cutoff), steps)
    filtered = [
        FilteredPart.of(even, block, within, by)
        for part, within in between
        for block in blocks(part, by.block, every)
    ]
    speed_noise, acceleration_noise = _noise(filtered, by)
    busiest = np.max([p.busiest for p in filtered], axis=0)
    parted = {name: [getattr(p, name) for p in filtered] for name in ("q", "v", "a", "effort", "temperature")}
    del filtered  # a signal's parts are freed as soon as they are joined
    a = _joined(parted.pop("a"))
    # else inertias would be fitted to the noise in the acceleration of a joint that hardly accelerates
    drowned = busiest < DROWNED * acceleration_noise**2
    a[:, drowned] = 0.0
    warmth = [part for part in parted.pop("temperature") if part is not None]
    return Motion(
        joints=log.joints,
        time=_joined(even.time[part][::every] for part in parts),
        q=_joined(parted.pop("q")),
        v=_joined(parted.pop("v")),
        a=a,
        effort=_joined(parted.pop("effort")),
        rate=rate / every,
        cutoff=cutoff,
        decimation=again,
        speed_noise=speed_noise,
        acceleration_noise=acceleration_noise,
        effort_step=np.array([_effort_step(of_joint) for of_joint in raw_effort.T]),
        record=MotionRecord(
            cutoff=cutoff,
            motion_cutoff=wide,
            trim=settings.trim,
            source=log.source,
            condition=log.condition,
            sha256=log.sha256,
            log_rate=rate,
            motion_rate=rate / every,
            compared_rate=rate / every / again,
            velocity="derived from position",
            acceleration_drowned=[j for j, lost in zip(log.joints, drowned, strict=True) if lost],
            notes=notes,
        ),
        # drives report it in whole degrees
        temperature=_joined(warmth) if warmth else None,
        torque_side=log.torque_side,
        side_of_format=log.side_of_format,
        effort_tolerance=log.effort_tolerance,
        stretches=lengths,
    )


def _said_of_gaps(log: Log, used: int) -> str:
    """Return what a log's gaps are, and how many parts between them are looked at."""
    step, parts = np.diff(log.time), len(recorded_parts(log))
    which = "each of its parts" if used == parts else f"{used} of its {parts} parts"
    return (
        f"the clock has {counted(parts - 1, 'long gap')} of up to {step.max():.3g} s, the longest after "
        f"t = {log.time[step.argmax()]:.4g} s; {which} between them is looked at by itself"
    )


def _noise(parts: Sequence[FilteredPart], by: Filter) -> tuple[Array, Array]:
    """Estimate standard deviations of the speed [rad/s] and of the compared acceleration [rad/s²], shape (n,) each."""
    # of white noise of the positions, from what the filter removed
    white = np.sqrt(mean([p.removed for p in parts], parts)) / np.sqrt(
        max(1.0 - 2 * by.motion / by.rate, 0.1)
    )
    of_speed = _of_derivative(white, 1, by.motion, by.rate)
    of_acceleration = _of_derivative(white, 2, by.cutoff, by.rate)
    return of_speed, np.maximum(of_acceleration, np.sqrt(mean([p.rounding for p in parts], parts)))


def _of_derivative(white: Array, order: int, cutoff: float, rate: float) -> Array:
    """Return the standard deviation of a derivative of white noise below a cut-off [1/s per order], shape (n,)."""
    return np.asarray(white * (2 * np.pi * cutoff) ** order * np.sqrt(2 * cutoff / rate / (2 * order + 1)))


def _joined(signals: Iterable[Array]) -> Array:
    """Return the signals of all parts behind each other."""
    parts = list(signals)
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _effort_step(effort: Array) -> float:
    """Return the step of an effort [N·m or N].

    An effort that never changes shows no step. The step may then be as large as the effort itself.
    """
    return quantum(effort) if np.ptp(effort) else float(abs(effort[0]))
