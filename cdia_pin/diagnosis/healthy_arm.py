r"""The healthy arm as its runs show it: corrections of the model, and the size of a healthy residual.

The bound of a healthy residual is learned last, for motion and for rest (`moving_residual`). It is the largest residual
seen times a margin, and at least a multiple of its RMS, because the largest value of a minute is not that of an hour. A
model that was corrected by one half of the motion is tried on the other half as well, and the larger residual counts.
From less than two minutes the bound is widened, because the largest residual grows with time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.calibration import calibrated
from cdia_pin.diagnosis.growth import REFERENCE_DURATION, growth, moving_time
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.moving_residual import LEAST_MOTION, bound_of, correlation_time, learn_moving
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.refitted_halves import refitted_halves
from cdia_pin.diagnosis.residuals import (
    aligned_velocity,
    least_piece,
    pooled,
    ranges,
    sign_width,
    watched,
)
from cdia_pin.diagnosis.sight import Sight, blind_advice
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.errors import LogError
from cdia_pin.logs.log import Log
from cdia_pin.phrases import some

Array = NDArray[np.float64]

ENOUGH_DURATION = 20.0  # [s], of all healthy runs together, below which a note says how wide thresholds are
LEAST_DURATION = 2.0  # [s], of all healthy runs together: a second for the level beside the settling filters
ASSUMED_MEMORY = 0.1  # [s], correlation time of a healthy residual where it was not measured
ASSUMED_SIGN_WIDTH = 0.005  # [rad/s or m/s], smoothing of sgn where noise was not measured
# [s], most that samples count as alike in a decision. A model's error follows the posture for seconds, but not in the
# shape of a fault's columns; counted in full it would hide faults twice its size.
LONGEST_ALIKE = 0.5
TINY = 1e-12  # keeps a residual that is zero from dividing by zero


@dataclass(frozen=True)
class HealthyArm:
    """What is known of the healthy arm.

    Attributes:
        nominal: The model as the runs corrected it.
        bandwidth: γ of each joint [1/s], shape (n,).
        bound: η₀ of each joint while it moves [N·m or N], shape (n,).
        rest_bound: η₀ of each joint near rest, where friction turns round [N·m or N], shape (n,).
        level: RMS of a healthy residual in motion, in the worst second [N·m or N], shape (n,).
        memory: Correlation time of a healthy residual [s], shape (n,).
        moving_memory: The same in motion [s], shape (n,).
        sign_width: Speed over which sgn q̇ is smoothed [rad/s or m/s], shape (n,).
        position_range: Smallest and largest position seen [rad or m], shape (2, n).
        velocity_range: Smallest and largest velocity seen [rad/s or m/s], shape (2, n).
        torque: RMS torque of healthy motion [N·m or N], shape (n,); not a number where there were no runs.
        notes: What was learned, one sentence each.
    """

    nominal: Nominal
    bandwidth: Array
    bound: Array
    rest_bound: Array
    level: Array
    memory: Array
    moving_memory: Array
    sign_width: Array
    position_range: Array
    velocity_range: Array
    torque: Array
    notes: tuple[str, ...] = ()

    @property
    def is_measured(self) -> bool:
        """Whether it comes from runs, and not from a given threshold."""
        return bool(np.isfinite(self.torque).all())

    @property
    def independent(self) -> Array:
        """Time for which samples of a joint count as alike in a decision [s], shape (n,)."""
        return np.minimum(self.moving_memory, np.maximum(LONGEST_ALIKE, 1.0 / self.bandwidth))

    @property
    def sight(self) -> Sight:
        """Thresholds beside torques."""
        return Sight(self.nominal.robot.joints, self.bound, self.torque)


def learn_healthy_arm(
    model: Dynamics, runs: Sequence[Log], bank: Bank, settings: MonitorSettings
) -> HealthyArm:
    """Learn from runs of a healthy arm.

    Args:
        model: The model.
        runs: Logs at the rate of the monitor.
        bank: The monitor's bank; only so that what is compiled here serves the monitor too.
        settings: Bandwidth, margins, and whether masses are corrected.

    Raises:
        LogError: If the runs are too short, at rest, or belong to other joints.
    """
    least = least_piece(settings)
    runs = [run for run in runs if run.duration >= least]
    nominal = Nominal.of(model)
    dt = _check(nominal, runs)
    found = calibrated(nominal, runs, dt, bank, settings)
    nominal, notes = found.nominal, list(found.notes)
    seen = watched(nominal, runs, dt, bank, settings)
    bandwidth = _bandwidth(bound_of([one.residual for one in seen], settings), runs, settings)
    if (bandwidth < settings.bandwidth).any():
        seen = watched(nominal, runs, dt, bank, settings, bandwidth)
        slow = [
            f"{j} {g:.0f}/s" for j, g in zip(runs[0].joints, bandwidth, strict=True) if g < settings.bandwidth
        ]
        notes.append(f"slower filters because of sensor noise: {', '.join(slow)}")
    unseen = [
        one for model, other in found.unseen for one in watched(model, other, dt, bank, settings, bandwidth)
    ]
    memory = np.array(
        [correlation_time([one.residual[:, j] for one in seen], dt) for j in range(nominal.robot.n)]
    )
    memory = np.maximum(memory, 1 / bandwidth)
    velocities = [aligned_velocity(run, dt) for run in runs]
    width = sign_width(velocities)
    moved = moving_time(velocities, width, dt)
    wider = growth(moved, memory)
    bounds = [bound_of([one.residual for one in part], settings, wider) for part in (seen, unseen) if part]
    rest_bound = np.max(bounds, axis=0)
    rest_bound = _unknown_without_motion(rest_bound, moved, nominal.robot.limits.effort)
    torque = pooled([run.effort for run in runs])
    for half, other in refitted_halves(model, runs, least):
        unseen += watched(half.corrected(nominal.delay, nominal.masses), other, dt, bank, settings, bandwidth)
    moving = learn_moving(seen, unseen, dt, rest_bound, torque, settings)
    bound = np.where(moved < LEAST_MOTION, rest_bound, moving.bound)
    notes += _what_was_missing(nominal, moved, wider, Sight(runs[0].joints, bound, torque))
    return HealthyArm(
        nominal=nominal,
        bandwidth=bandwidth,
        bound=bound,
        rest_bound=rest_bound,
        level=moving.level,
        memory=memory,
        moving_memory=np.maximum(moving.memory, 1 / bandwidth),
        sign_width=width,
        position_range=ranges([run.position for run in runs]),
        velocity_range=ranges(velocities),
        torque=torque,
        notes=tuple(notes),
    )


def _what_was_missing(nominal: Nominal, moved: Array, wider: Array, sight: Sight) -> list[str]:
    """Return a sentence on each of: little motion, joints that did not move, joints that are blind."""
    notes = []
    if moved.max() < ENOUGH_DURATION:
        notes.append(
            f"only {moved.max():.3g} s of healthy motion: thresholds are up to {wider.max():.1f} × wider than from "
            f"{REFERENCE_DURATION:.0f} s; give {ENOUGH_DURATION:.0f} s or more"
        )
    if unmoved := [j for j, seconds in zip(sight.joints, moved, strict=True) if seconds < LEAST_MOTION]:
        notes.append(
            f"less than {LEAST_MOTION:g} s of motion on {some(unmoved)}: its healthy residual is not known, and the "
            "threshold is the effort limit; give healthy runs in which every joint moves"
        )
    if advice := blind_advice(sight.blind, bool(nominal.of_joints or nominal.others.terms)):
        notes.append(advice)
    return notes


def _unknown_without_motion(bound: Array, moved: Array, limit: Array) -> Array:
    """Return the bound, at least the effort limit where a joint did not move; limits not stated are infinite."""
    return np.where((moved < LEAST_MOTION) & np.isfinite(limit), np.maximum(bound, limit), bound)


def _bandwidth(bound: Array, runs: Sequence[Log], settings: MonitorSettings) -> Array:
    """Return γ of each joint [1/s], shape (n,): sensor noise grows with it, and is kept to a share of the torque."""
    torque = pooled([run.effort for run in runs])
    wanted = settings.bandwidth * settings.sensitivity * torque / np.maximum(bound, TINY)
    return np.asarray(np.clip(wanted, min(settings.slowest, settings.bandwidth), settings.bandwidth))


def assumed_healthy_arm(
    nominal: Nominal, threshold: Mapping[str, float], settings: MonitorSettings
) -> HealthyArm:
    """Return what a given threshold says of the healthy arm; the rest takes usual values.

    Args:
        nominal: The model.
        threshold: Largest healthy residual of each joint [N·m or N].
        settings: Bandwidth and margins.
    """
    robot = nominal.robot
    bound = np.array([threshold[joint] for joint in robot.joints])
    limits = robot.limits
    memory = np.full(robot.n, ASSUMED_MEMORY)
    bandwidth = np.full(robot.n, settings.bandwidth)
    return HealthyArm(
        nominal=nominal,
        bandwidth=bandwidth,
        bound=bound,
        rest_bound=bound,
        level=bound / settings.noise_margin,
        memory=memory,
        moving_memory=memory,
        sign_width=np.full(robot.n, ASSUMED_SIGN_WIDTH),
        position_range=np.array([limits.lower, limits.upper]),
        velocity_range=np.array([-limits.velocity, limits.velocity]),
        torque=np.full(robot.n, np.nan),
    )


def _check(nominal: Nominal, runs: Sequence[Log]) -> float:
    robot = nominal.robot
    for run in runs:
        if run.joints != robot.joints:
            raise LogError(
                f"{run.source}: joints are {', '.join(run.joints)}; expected {', '.join(robot.joints)}"
            )
    total = sum(r.duration for r in runs)  # of runs in which the filters settle
    if total < LEAST_DURATION:
        raise LogError(
            f"healthy runs of {total:.2g} s are too short to learn from; give {LEAST_DURATION:g} s or more"
        )
    if not any(np.ptp(run.position, axis=0).any() for run in runs):
        raise LogError(
            f"{runs[0].source}: nothing moves in the healthy runs; give runs in which the arm moves"
        )
    if len({r.velocity is None for r in runs}) > 1:
        raise LogError("either all healthy runs have velocities or none")
    return 1.0 / float(np.median([r.rate for r in runs]))
