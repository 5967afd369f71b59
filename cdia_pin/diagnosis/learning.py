r"""What healthy runs teach: what they correct of the model, and how large a healthy residual is.

The bound of a healthy residual is taken after the rest has been learned. It is the largest residual seen times a
margin, and never less than a multiple of its RMS: the largest of a minute is not that of an hour.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.calibration import calibrated
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.observer import NARROWEST
from cdia_pin.diagnosis.residuals import aligned_velocity, pooled, residuals_of, velocity_noise
from cdia_pin.diagnosis.settings import MonitorSettings
from cdia_pin.errors import LogError
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

ENOUGH = 20.0  # [s], of all healthy runs together, below which a note is made
SHORTEST = 2.0  # [s], of all healthy runs together
ASSUMED_MEMORY = 0.1  # [s], correlation time of a healthy residual where it was not measured
ASSUMED_WIDTH = 0.005  # [rad/s or m/s], smoothing of sgn where noise was not measured
LEVEL_WINDOW = 1.0  # [s], over which the healthy level is taken


@dataclass(frozen=True)
class Healthy:
    """What is known of a healthy arm under a monitor.

    Attributes:
        nominal: The model, with what the runs corrected.
        bandwidth: γ of each joint [1/s], shape (n,).
        bound: η₀ of each joint [N·m or N], shape (n,).
        level: RMS of a healthy residual in the worst second [N·m or N], shape (n,).
        memory: Correlation time of a healthy residual [s], shape (n,).
        sign_width: Speed over which sgn q̇ is smoothed, two deviations of the velocity's noise, shape (n,).
        reach: Smallest and largest position and velocity seen, shape (2, 2, n): position and velocity, then ends.
        notes: What was learned, one sentence each.
    """

    nominal: Nominal
    bandwidth: Array
    bound: Array
    level: Array
    memory: Array
    sign_width: Array
    reach: Array
    notes: tuple[str, ...] = ()


def learn(nominal: Nominal, runs: Sequence[Log], bank: Bank, settings: MonitorSettings) -> Healthy:
    """Learn from runs of a healthy arm.

    Args:
        nominal: The model.
        runs: Logs at the rate at which the monitor will run.
        bank: The monitor's; its columns are not used, but what runs here is then compiled for it too.
        settings: Bandwidth, margins, and whether masses are corrected.

    Raises:
        LogError: If the runs are too short, at rest, belong to other joints, or differ in rate.
    """
    dt = _check(nominal, runs)
    notes = []
    if (seconds := sum(run.duration for run in runs)) < ENOUGH:
        notes.append(
            f"only {seconds:.0f} s of healthy motion: thresholds may be too low for motions that were not seen; "
            f"{ENOUGH:.0f} s or more are better"
        )
    nominal, corrected = calibrated(nominal, runs, dt, bank, settings)
    notes += corrected
    residuals = residuals_of(nominal, runs, dt, bank, settings)
    bandwidth = _bandwidth(_bound(residuals, settings), runs, settings)
    if (bandwidth < settings.bandwidth).any():
        residuals = residuals_of(nominal, runs, dt, bank, settings, bandwidth)
        slow = [
            f"{j} {g:.0f}/s" for j, g in zip(runs[0].joints, bandwidth, strict=True) if g < settings.bandwidth
        ]
        notes.append(f"slower filters against sensor noise: {', '.join(slow)}")
    bound = _bound(residuals, settings)
    window = max(1, round(LEVEL_WINDOW / dt))
    width = np.maximum(2 * velocity_noise(runs, dt), NARROWEST)
    v = [aligned_velocity(run, dt) for run in runs]
    reach = np.array([[_extreme(np.min, [r.position for r in runs]), _extreme(np.max, [r.position for r in runs])],
                      [_extreme(np.min, v), _extreme(np.max, v)]])  # fmt: skip
    level = np.max([_worst_window(r, window) for r in residuals], axis=0)
    memory = np.array([_correlation_time([r[:, j] for r in residuals], dt) for j in range(nominal.robot.n)])
    return Healthy(
        nominal, bandwidth, bound, level, np.maximum(memory, 1 / bandwidth), width, reach, tuple(notes)
    )


def _bound(residuals: Sequence[Array], settings: MonitorSettings) -> Array:
    """Return what the residual of a healthy arm stays below [N·m or N], shape (n,)."""
    largest = np.max([np.abs(r).max(axis=0) for r in residuals], axis=0)
    return np.maximum(settings.margin * largest, settings.noise_margin * pooled(residuals))


def _bandwidth(bound: Array, runs: Sequence[Log], settings: MonitorSettings) -> Array:
    """Return γ of each joint [1/s]: sensor noise grows with it, and is kept to a share of the joint's torque."""
    torque = pooled([run.effort for run in runs])
    wanted = settings.bandwidth * settings.sensitivity * torque / np.maximum(bound, 1e-12)
    return np.clip(wanted, min(settings.slowest, settings.bandwidth), settings.bandwidth)


def assumed(nominal: Nominal, threshold: Mapping[str, float], settings: MonitorSettings) -> Healthy:
    """Return what a given threshold says of a healthy arm [N·m or N]."""
    robot = nominal.robot
    bound = np.array([threshold[joint] for joint in robot.joints])
    limits = robot.limits
    reach = np.array([[limits.lower, limits.upper], [-limits.velocity, limits.velocity]])
    memory = np.full(robot.n, ASSUMED_MEMORY)
    width = np.full(robot.n, ASSUMED_WIDTH)
    bandwidth = np.full(robot.n, settings.bandwidth)
    return Healthy(nominal, bandwidth, bound, bound / settings.noise_margin, memory, width, reach)


def _check(nominal: Nominal, runs: Sequence[Log]) -> float:
    robot = nominal.robot
    for run in runs:
        if run.joints != robot.joints:
            raise LogError(
                f"{run.source}: joints are {', '.join(run.joints)}; expected {', '.join(robot.joints)}"
            )
    total = sum(r.duration for r in runs)
    if total < SHORTEST:
        raise LogError(
            f"healthy runs of {total:.2g} s are too short to learn from; give {SHORTEST:g} s or more"
        )
    if not any(np.ptp(run.position, axis=0).any() for run in runs):
        raise LogError(f"{runs[0].source}: nothing moves in the healthy runs; there is nothing to learn from")
    rates = [r.rate for r in runs]
    if max(rates) > 1.2 * min(rates):
        raise LogError(f"healthy runs must share one rate, given {min(rates):.0f} to {max(rates):.0f} Hz")
    if len({r.velocity is None for r in runs}) > 1:
        raise LogError("either all healthy runs have velocities or none")
    return 1.0 / float(np.median(rates))


def _worst_window(r: Array, window: int) -> Array:
    """Return the RMS of the worst window, shape (n,)."""
    total = np.vstack([np.zeros(r.shape[1]), np.cumsum(r**2, axis=0)])
    window = min(window, len(r))
    return np.asarray(np.sqrt((total[window:] - total[:-window]).max(axis=0) / window))


def _correlation_time(series: Sequence[Array], dt: float) -> float:
    """Return the time over which a residual forgets itself: the sum of its autocorrelation to the first zero [s]."""
    longest = max(series, key=len)
    x = longest - longest.mean()
    size = 1 << (2 * len(x) - 1).bit_length()
    spectrum = np.abs(np.fft.rfft(x, size)) ** 2
    auto = np.fft.irfft(spectrum)[: len(x) // 2]
    auto /= auto[0] if auto[0] > 0 else 1.0
    negative = np.flatnonzero(auto <= 0)
    return float(dt * (2 * auto[: negative[0] if len(negative) else len(auto)].sum() - 1))


def _extreme(which: Callable[..., Array], signals: Sequence[Array]) -> Array:
    return np.asarray(which(np.array([which(s, axis=0) for s in signals]), axis=0))
