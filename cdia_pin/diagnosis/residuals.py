"""Residuals of whole runs of a healthy arm, as a monitor computes them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.alignment import Alignment, slope_of
from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.kernels import MOVING_SHARE
from cdia_pin.diagnosis.momentum_observer import LEAST_SIGN_WIDTH, MomentumObserver
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

SETTLING = 5.0  # [1], time constants of the filter until a run counts: it has then forgotten its start to 1 %
PIECES = 1.3  # [1], least length of a run that counts, or is cut, over the time in which the slowest filter settles
NOISE_WIDTHS = 2.0  # [1], standard deviations of the velocity's noise over which sgn q̇ is smoothed
NORMAL_MEDIAN = 1.4826  # [1], standard deviation over the median size of normal noise


@dataclass(frozen=True)
class Watched:
    """What an observer has seen along a run of a healthy arm, from when its filters have settled.

    Attributes:
        residual: Residual [N·m or N], shape (K, n).
        moves: Whether the joint has moved for as long as the filter remembers, shape (K, n).
    """

    residual: Array
    moves: NDArray[np.bool_]


def least_piece(settings: MonitorSettings) -> float:
    """Return the length of a run below which the filters may not settle in it [s].

    Args:
        settings: Bandwidths of the filters.
    """
    return PIECES * SETTLING / min(settings.slowest, settings.bandwidth)


def watched(
    nominal: Nominal,
    runs: Sequence[Log],
    dt: float,
    bank: Bank,
    settings: MonitorSettings,
    bandwidth: Array | None = None,
) -> list[Watched]:
    """Return what an observer sees along runs.

    Args:
        nominal: The model.
        runs: Logs, all with velocities or all without.
        dt: Time between ticks [s].
        bank: The monitor's bank, so that what is compiled here serves the monitor too.
        settings: Settings of the monitor, for its filter.
        bandwidth: γ of each joint [1/s], shape (n,); that of the settings if omitted.
    """
    velocities = [aligned_velocity(run, dt) for run in runs]
    observer = MomentumObserver(nominal, bank.prototypes, settings, dt, bandwidth=bandwidth)
    observer.use_sign_width(sign_width(velocities))
    observer.use_velocities(ranges(velocities))
    alignment = Alignment(dt, nominal.delay, runs[0].velocity is None)
    return [watched_along(observer, alignment, run) for run in runs]


def watched_along(observer: MomentumObserver, alignment: Alignment, run: Log) -> Watched:
    """Return what an observer sees along a run, from when the filter has settled.

    Args:
        observer: Returned to its start first.
        alignment: Returned to its start first.
        run: At the rate of the alignment.
    """
    seen = [
        (observer.residual.copy(), observer.state.moving > MOVING_SHARE)
        for _, is_settled in along(observer, alignment, run)
        if is_settled
    ]
    # The shape holds also for a run that ends before the filter settles.
    residual, moves = (np.array([s[i] for s in seen]).reshape(-1, run.position.shape[1]) for i in (0, 1))
    return Watched(residual, moves.astype(bool))


def along(observer: MomentumObserver, alignment: Alignment, run: Log) -> Iterator[tuple[float, bool]]:
    """Let an observer see a run, and yield the time of each tick [s] and whether its filters have settled.

    Args:
        observer: Returned to its start first.
        alignment: Returned to its start first.
        run: At the rate of the alignment.
    """
    observer.reset()
    alignment.reset()
    begin: float | None = None
    for k in range(len(run.time)):
        v = None if run.velocity is None else run.velocity[k]
        sample = alignment(float(run.time[k]), run.position[k], v, run.effort[k])
        if sample is None:
            continue
        t, q, v, tau = sample
        observer.step(t, q + observer.nominal.offset, v, tau)
        begin = t if begin is None else begin
        yield t, t - begin > SETTLING / observer.bandwidth.min()


def sign_width(velocities: Sequence[Array]) -> Array:
    """Return the speed over which sgn q̇ is smoothed [rad/s or m/s], shape (n,).

    Args:
        velocities: Of each run [rad/s or m/s], shape (K, n) each.
    """
    return np.asarray(np.maximum(NOISE_WIDTHS * velocity_noise(velocities), LEAST_SIGN_WIDTH))


def velocity_noise(velocities: Sequence[Array]) -> Array:
    """Return the standard deviation of the velocities' white noise [rad/s or m/s], shape (n,).

    Args:
        velocities: Of each run [rad/s or m/s], shape (K, n) each.
    """
    third = [np.diff(v, n=3, axis=0) for v in velocities]
    # Third differences of white noise have the variance 1 + 9 + 9 + 1; the median ignores reversals.
    return np.asarray(NORMAL_MEDIAN * np.median(np.abs(np.concatenate(third)), axis=0) / np.sqrt(20.0))


def aligned_velocity(run: Log, dt: float) -> Array:
    """Return the measured velocities, or those that the alignment derives [rad/s or m/s], shape (K, n).

    Args:
        run: A log.
        dt: Time between samples [s].
    """
    return run.velocity if run.velocity is not None else slope_of(run.position, dt)[1]


def pooled(signals: Sequence[Array]) -> Array:
    """Return the RMS of several signals together, shape (n,).

    Args:
        signals: Each of shape (K, n).
    """
    return np.asarray(np.sqrt(np.mean(np.concatenate(signals) ** 2, axis=0)))


def ranges(signals: Sequence[Array]) -> Array:
    """Return the smallest and the largest value of signals of shape (K, n), shape (2, n).

    Args:
        signals: Each of shape (K, n).
    """
    together = np.concatenate(signals)
    return np.array([together.min(axis=0), together.max(axis=0)])
