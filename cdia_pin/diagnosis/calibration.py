"""Calibration of a model by healthy runs: the delay of the torques, and small errors of the masses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.alignment import slope_of
from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.healthy_part import halves
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.residuals import SETTLING, least_piece, pooled, watched
from cdia_pin.logs.log import Log
from cdia_pin.robot.model import RobotModel
from cdia_pin.threads import on_one_thread

Array = NDArray[np.float64]

LONGEST_DELAY = 0.010  # [s], longest delay of a torque loop that is searched; usual drives have 1 to 5 ms
DELAY_SEARCH = 60.0  # [s], part of the longest run on which the delay is searched: more adds nothing
WORTHWHILE = 0.98  # [1], residual left, below which a delay or a correction of masses is accepted
PRIOR_ERROR = 0.05  # [1], prior standard deviation of an inertial parameter, relative
LEAST_LINK_SIZE = 0.1  # [m], least length by which first and second moments of a link are scaled
LEAST_MASS = 1e-3  # [kg], by which the moments of a massless link are scaled
ROWS_PER_SECOND = 100  # [1/s], rows of the regression of the masses
INDEPENDENT_TIME = 0.1  # [s] of motion that count as one independent row
REWEIGHTINGS = 3  # of the joints by what they leave: the weights settle after two
TURNS = 5  # between masses and delay; they usually settle after two
TINY = 1e-12  # keeps a signal that is zero from dividing by zero


@dataclass(frozen=True)
class Calibration:
    """A model corrected by healthy runs, and what shows how well it predicts motion that it was not fitted to.

    Attributes:
        nominal: The model, corrected by all runs.
        unseen: Models corrected by one half of the motion, each with the other half; empty if nothing but the delay
            was fitted.
        notes: One sentence for each correction.
    """

    nominal: Nominal
    unseen: tuple[tuple[Nominal, tuple[Log, ...]], ...]
    notes: tuple[str, ...]


@on_one_thread
def calibrated(
    given: Nominal, runs: Sequence[Log], dt: float, bank: Bank, settings: MonitorSettings
) -> Calibration:
    """Correct the delay of a model and, if that is asked for and worthwhile, its masses.

    Masses are worthwhile if those of one half of the motion explain the other half better than the given ones do.

    Args:
        given: The model.
        runs: Runs of the healthy arm.
        dt: Time between ticks [s].
        bank: The monitor's bank.
        settings: Bandwidth, and whether masses are corrected.
    """
    nominal, notes = _fitted(given, runs, dt, bank, settings), []
    if nominal.delay != given.delay:
        notes.append(f"torques act {1e3 * nominal.delay:.1f} ms after their signal")
    if not settings.calibrate:
        return Calibration(nominal, (), tuple(notes))
    plain = replace(given, delay=nominal.delay)
    first, second = halves(runs, least_piece(settings))
    unseen = (
        (_fitted(given, first, dt, bank, settings), second),
        (_fitted(given, second, dt, bank, settings), first),
    )
    stated = pooled([one.residual for one in watched(plain, runs, dt, bank, settings)])
    after = pooled(
        [one.residual for model, other in unseen for one in watched(model, other, dt, bank, settings)]
    )
    share = float(np.mean(after / np.maximum(stated, TINY)))
    if share > WORTHWHILE:
        return Calibration(plain, (), tuple(notes))
    notes.append(
        f"masses corrected by the healthy runs: {share:.0%} of the residual is left on the half not fitted"
    )
    return Calibration(nominal, unseen, tuple(notes))


def _fitted(given: Nominal, runs: Sequence[Log], dt: float, bank: Bank, settings: MonitorSettings) -> Nominal:
    """Return a model with delay and masses fitted; an error of the one hides the other, so both take turns."""
    nominal = given
    for _ in range(TURNS):
        before = nominal.delay
        if settings.calibrate:
            nominal = _with_masses(replace(given, delay=before), runs, dt, bank, settings)
        nominal = replace(nominal, delay=_delay(nominal, runs, dt, settings, given.delay))
        if nominal.delay == before:
            break
    return nominal


@dataclass(frozen=True)
class _Signals:
    """A run with all signals of a row at one instant: state, and torque without its delay; shape (K, n) each."""

    q: Array
    v: Array
    a: Array
    tau: Array


def _signals(run: Log, nominal: Nominal, dt: float, delay: float) -> _Signals:
    if run.velocity is None:
        q, v = slope_of(run.position, dt)
        half = (len(run.position) - len(q)) // 2
        time = run.time[half : half + len(q)]
    else:
        q, v, time = run.position, run.velocity, run.time
    tau = np.column_stack([np.interp(time - delay, run.time, column) for column in run.effort.T])
    middle = 0.5 * (v[1:] + v[:-1])
    return _Signals(0.5 * (q[1:] + q[:-1]) + nominal.offset, middle, np.diff(v, axis=0) / dt, tau[1:])


def _filter(
    x: Array, dt: float, settings: MonitorSettings, state: Array | None = None
) -> tuple[Array, Array]:
    """Apply the filter of the residual along time."""
    from scipy.signal import lfilter

    E = np.exp(-settings.bandwidth * dt)
    zi = np.zeros((1, *x.shape[1:])) if state is None else state
    filtered, state = lfilter([1 - E], [1, -E], x, axis=0, zi=zi)
    return filtered, state


def _delay(
    nominal: Nominal, runs: Sequence[Log], dt: float, settings: MonitorSettings, stated: float
) -> float:
    """Return the delay of least residual, in half ticks [s]; the stated one where none is clearly better."""
    run = max(runs, key=lambda r: r.duration)
    run = run.slice(0, min(len(run.time), round(DELAY_SEARCH / dt)))
    candidates = sorted({stated, *(0.5 * dt * i for i in range(int(2 * LONGEST_DELAY / dt) + 1))})
    first = candidates.index(stated)
    settle = round(SETTLING / settings.bandwidth / dt)
    left = []
    x = _signals(run, nominal, dt, nominal.delay)
    known = nominal.robot.inverse_dynamics(x.q, x.v, x.a)
    ticks = np.arange(len(x.tau), dtype=float)
    scale = x.tau.std(axis=0) + TINY
    for delay in candidates:
        late = ticks - (delay - nominal.delay) / dt
        tau = np.column_stack([np.interp(late, ticks, column) for column in x.tau.T])
        r, _ = _filter(known - tau, dt, settings)
        left.append(float(np.mean((r[settle:].std(axis=0) / scale) ** 2)))
    best = int(np.argmin(left))
    return candidates[best] if left[best] < WORTHWHILE * left[first] else stated


def _with_masses(
    nominal: Nominal, runs: Sequence[Log], dt: float, bank: Bank, settings: MonitorSettings
) -> Nominal:
    """Return the model with inertial parameters corrected by ridge regression; unchanged if a mass would vanish."""
    robot = nominal.robot
    seen = watched(nominal, runs, dt, bank, settings)
    every = max(1, round(1 / ROWS_PER_SECOND / dt))
    regressors, missing = [], []
    for run, one in zip(runs, seen, strict=True):
        y = _filtered_regressor(_signals(run, nominal, dt, nominal.delay), robot, dt, settings, every)
        thinned = one.residual[::-1][::every][::-1]  # both end at the last sample
        count = min(len(thinned), len(y))
        regressors.append(y[-count:])
        missing.append(thinned[-count:])
    Y, r = (
        np.concatenate(regressors),
        -np.concatenate(missing),
    )  # bodies that are too heavy make the residual positive
    precision = 1.0 / _prior_standard_deviations(robot) ** 2
    sigma = r.std(axis=0) + TINY
    delta = np.zeros(10 * robot.n)
    independent = max(1.0, INDEPENDENT_TIME / (every * dt))  # rows that count as one
    for _ in range(REWEIGHTINGS):
        weighted = Y / sigma[:, None]
        gram = np.einsum("kji,kjm->im", weighted, weighted) / independent
        right = np.einsum("kji,kj->i", weighted, r / sigma) / independent
        unit = np.sqrt(1.0 / precision)
        delta = unit * np.linalg.solve(gram * np.outer(unit, unit) + np.eye(len(unit)), unit * right)
        sigma = (r - Y @ delta).std(axis=0) + TINY
    pi = robot.inertial_parameters + delta.reshape(robot.n, 10)
    if (pi[:, 0] <= 0).any():
        return nominal
    return nominal.corrected(nominal.delay, pi)


def _filtered_regressor(
    x: _Signals, robot: RobotModel, dt: float, settings: MonitorSettings, every: int
) -> Array:
    """Return rows of the filtered regressor, the last at the last sample, shape (K, n, 10 n)."""
    state, out, begin = None, [], (len(x.q) - 1) % every
    chunk = every * 100
    for start in range(0, len(x.q), chunk):
        part = np.s_[start : start + chunk]
        y, state = _filter(robot.torque_regressor(x.q[part], x.v[part], x.a[part]), dt, settings, state)
        out.append(y[begin::every])
    return np.concatenate(out)


def _prior_standard_deviations(robot: RobotModel) -> Array:
    """Return the prior standard deviation of every inertial parameter, shape (10 n,)."""
    rows = []
    for p in robot.inertial_parameters:
        mass = max(p[0], LEAST_MASS)
        size = max(float(np.linalg.norm(p[1:4])) / mass, LEAST_LINK_SIZE)
        rows.append([mass, *[mass * size] * 3, *[mass * size**2] * 6])
    return PRIOR_ERROR * np.concatenate(rows)
