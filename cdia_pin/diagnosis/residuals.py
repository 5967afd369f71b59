"""Residuals of whole runs of a healthy arm, as a monitor would have had them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.alignment import Alignment, slope_of
from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.observer import Observer
from cdia_pin.diagnosis.settings import MonitorSettings
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

SETTLE = 5.0  # time constants of the filter before a run counts


def residuals_of(
    nominal: Nominal,
    runs: Sequence[Log],
    dt: float,
    bank: Bank,
    settings: MonitorSettings,
    bandwidth: Array | None = None,
) -> list[Array]:
    """Return the residuals of runs [N·m or N], shape (K, n) each.

    Args:
        nominal: The model.
        runs: Logs, all with velocities or all without.
        dt: Time between ticks [s].
        bank: Of the monitor, so that what is compiled here serves it too.
        settings: Of the filter.
        bandwidth: γ of each joint [1/s], shape (n,); that of the settings if omitted.
    """
    observer = Observer(nominal, bank.prototypes, settings, dt, bandwidth=bandwidth)
    observer.use_width(2 * velocity_noise(runs, dt))
    alignment = Alignment(dt, nominal.delay, runs[0].velocity is None)
    return [replay(observer, alignment, run) for run in runs]


def replay(observer: Observer, alignment: Alignment, run: Log) -> Array:
    """Return the residuals of a run, once the filter has settled [N·m or N], shape (K, n)."""
    observer.reset()
    alignment.reset()
    out = []
    begin = None
    for k in range(len(run.time)):
        v = None if run.velocity is None else run.velocity[k]
        sample = alignment(float(run.time[k]), run.position[k], v, run.effort[k])
        if sample is None:
            continue
        t, q, v, tau = sample
        observer.step(t, q + observer.nominal.offset, v, tau)
        begin = t if begin is None else begin
        if t - begin > SETTLE / observer.bandwidth.min():
            out.append(observer.residual.copy())
    return np.array(out)


def velocity_noise(runs: Sequence[Log], dt: float) -> Array:
    """Return the standard deviation of the velocities' white noise [rad/s or m/s], shape (n,)."""
    third = [np.diff(aligned_velocity(run, dt), n=3, axis=0) for run in runs]
    # third differences of white noise have a variance of 1 + 9 + 9 + 1; the median ignores reversals
    return np.asarray(1.4826 * np.median(np.abs(np.concatenate(third)), axis=0) / np.sqrt(20.0))


def aligned_velocity(run: Log, dt: float) -> Array:
    """Return measured velocities, or those that the alignment makes of positions, shape (K, n)."""
    return run.velocity if run.velocity is not None else slope_of(run.position, dt)[1]


def pooled(signals: Sequence[Array]) -> Array:
    """Return the RMS of signals of shape (K, n) each, together, shape (n,)."""
    return np.asarray(np.sqrt(np.mean(np.concatenate(signals) ** 2, axis=0)))
