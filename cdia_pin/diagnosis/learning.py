r"""What healthy runs teach: the torque's delay, small errors of the masses, and how large a healthy residual is.

The bound of a healthy residual is taken after the rest has been learned. It is the largest residual seen times a
margin, and never less than a multiple of its RMS: the largest of a minute is not that of an hour.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.alignment import Alignment, slope_of
from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.observer import NARROWEST, Observer
from cdia_pin.diagnosis.settings import MonitorSettings
from cdia_pin.errors import LogError
from cdia_pin.logs.log import Log
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

DELAYS = 0.010  # [s], the longest delay of a torque loop that is looked for
WORTH = 0.98  # residual left, relative, below which a delay or a correction of masses is believed
SURPRISING = 0.05  # [1], error of an inertial parameter that would surprise nobody
REACH = 0.1  # [m], least scale of a link's size
ROWS_PER_SECOND = 100  # of the regression of the masses
PASSES = 3  # of its weights
TURNS = 5  # between masses and delay
SETTLE = 5.0  # time constants of the filter before a run counts
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
        LogError: If the runs are too short, belong to other joints, or differ in rate.
    """
    dt = _check(nominal, runs)
    notes, given = [], nominal
    if (seconds := sum(run.duration for run in runs)) < ENOUGH:
        notes.append(
            f"only {seconds:.0f} s of healthy motion: thresholds may be too low for motions that were not seen; "
            f"{ENOUGH:.0f} s or more are better"
        )
    # Masses and delay hide each other: a better guess of the one shows the other.
    for _ in range(TURNS):
        before = nominal.delay
        if settings.calibrate:
            nominal = _with_masses(replace(given, delay=before), runs, dt, bank, settings)
        nominal = replace(nominal, delay=_delay(nominal, runs, dt, settings, given.delay))
        if nominal.delay == before:
            break
    if nominal.delay != given.delay:
        notes.append(f"torques act {1e3 * nominal.delay:.1f} ms after their signal")
    if settings.calibrate:
        plain = replace(given, delay=nominal.delay)
        stated, after = (_pooled(_residuals(x, runs, dt, bank, settings)) for x in (plain, nominal))
        share = float(np.mean(after / stated))
        if share > WORTH:
            nominal = plain
        else:
            notes.append(f"masses corrected by the healthy runs: {share:.0%} of the residual is left")
    residuals = _residuals(nominal, runs, dt, bank, settings)
    bandwidth = _bandwidth(_bound(residuals, settings), runs, settings)
    if (bandwidth < settings.bandwidth).any():
        residuals = _residuals(nominal, runs, dt, bank, settings, bandwidth)
        slow = [
            f"{j} {g:.0f}/s" for j, g in zip(runs[0].joints, bandwidth, strict=True) if g < settings.bandwidth
        ]
        notes.append(f"slower filters against sensor noise: {', '.join(slow)}")
    bound = _bound(residuals, settings)
    window = max(1, round(LEVEL_WINDOW / dt))
    width = np.maximum(2 * velocity_noise(runs, dt), NARROWEST)
    v = [_aligned_velocity(run, dt) for run in runs]
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
    return np.maximum(settings.margin * largest, settings.noise_margin * _pooled(residuals))


def _bandwidth(bound: Array, runs: Sequence[Log], settings: MonitorSettings) -> Array:
    """Return γ of each joint [1/s]: sensor noise grows with it, and is kept to a share of the joint's torque."""
    torque = _pooled([run.effort for run in runs])
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


def velocity_noise(runs: Sequence[Log], dt: float) -> Array:
    """Return the standard deviation of the velocities' white noise [rad/s or m/s], shape (n,)."""
    third = [np.diff(_aligned_velocity(run, dt), n=3, axis=0) for run in runs]
    # third differences of white noise have a variance of 1 + 9 + 9 + 1; the median ignores reversals
    return np.asarray(1.4826 * np.median(np.abs(np.concatenate(third)), axis=0) / np.sqrt(20.0))


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
    rates = [r.rate for r in runs]
    if max(rates) > 1.2 * min(rates):
        raise LogError(f"healthy runs must share one rate, given {min(rates):.0f} to {max(rates):.0f} Hz")
    if len({r.velocity is None for r in runs}) > 1:
        raise LogError("either all healthy runs have velocities or none")
    return 1.0 / float(np.median(rates))


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


def _residuals(
    nominal: Nominal,
    runs: Sequence[Log],
    dt: float,
    bank: Bank,
    settings: MonitorSettings,
    bandwidth: Array | None = None,
) -> list[Array]:
    observer = Observer(nominal, bank.prototypes, settings, dt, bandwidth=bandwidth)
    observer.use_width(2 * velocity_noise(runs, dt))
    alignment = Alignment(dt, nominal.delay, runs[0].velocity is None)
    return [replay(observer, alignment, run) for run in runs]


def _pooled(residuals: Sequence[Array]) -> Array:
    return np.asarray(np.sqrt(np.mean(np.concatenate(residuals) ** 2, axis=0)))


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


def _aligned_velocity(run: Log, dt: float) -> Array:
    """Return measured velocities, or those that the alignment makes of positions, shape (K, n)."""
    return run.velocity if run.velocity is not None else slope_of(run.position, dt)[1]


# ----------------------------------------------------------------- delay and masses, over whole runs at once


@dataclass(frozen=True)
class _Signals:
    """A run at one instant per row: state, and torque with its own delay taken out; shape (K, n) each."""

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
    return lfilter([1 - E], [1, -E], x, axis=0, zi=zi)


def _delay(
    nominal: Nominal, runs: Sequence[Log], dt: float, settings: MonitorSettings, stated: float
) -> float:
    """Return the delay that leaves least, in half ticks; the stated one where none is clearly better."""
    run = max(runs, key=lambda r: r.duration)
    run = run.slice(0, min(len(run.time), round(60.0 / dt)))
    candidates = sorted({stated, *(0.5 * dt * i for i in range(int(2 * DELAYS / dt) + 1))})
    first = candidates.index(stated)
    settle = round(SETTLE / settings.bandwidth / dt)
    left = []
    x = _signals(run, nominal, dt, nominal.delay)
    known = nominal.robot.inverse_dynamics(x.q, x.v, x.a)
    ticks = np.arange(len(x.tau), dtype=float)
    scale = x.tau.std(axis=0) + 1e-12
    for delay in candidates:
        late = ticks - (delay - nominal.delay) / dt
        tau = np.column_stack([np.interp(late, ticks, column) for column in x.tau.T])
        r, _ = _filter(known - tau, dt, settings)
        left.append(float(np.mean((r[settle:].std(axis=0) / scale) ** 2)))
    best = int(np.argmin(left))
    return candidates[best] if left[best] < WORTH * left[first] else stated


def _with_masses(
    nominal: Nominal, runs: Sequence[Log], dt: float, bank: Bank, settings: MonitorSettings
) -> Nominal:
    """Return the model with inertial parameters nearer to what the runs say; as it is if a mass would vanish."""
    robot = nominal.robot
    residuals = _residuals(nominal, runs, dt, bank, settings)
    every = max(1, round(1 / ROWS_PER_SECOND / dt))
    regressors, lacking = [], []
    for run, r in zip(runs, residuals, strict=True):
        y = _filtered_regressor(_signals(run, nominal, dt, nominal.delay), robot, dt, settings, every)
        seldom = r[::-1][::every][::-1]  # both end at the last sample
        count = min(len(seldom), len(y))
        regressors.append(y[-count:])
        lacking.append(seldom[-count:])
    Y, r = np.concatenate(regressors), -np.concatenate(lacking)  # bodies too heavy make the residual positive
    prior = 1.0 / _scales(robot) ** 2
    sigma = r.std(axis=0) + 1e-12
    delta = np.zeros(10 * robot.n)
    independent = max(1.0, 0.1 / (every * dt))  # rows that count as one: 0.1 s of motion
    for _ in range(PASSES):
        weighted = Y / sigma[:, None]
        gram = np.einsum("kji,kjm->im", weighted, weighted) / independent
        right = np.einsum("kji,kj->i", weighted, r / sigma) / independent
        unit = np.sqrt(1.0 / prior)
        delta = unit * np.linalg.solve(gram * np.outer(unit, unit) + np.eye(len(unit)), unit * right)
        sigma = (r - Y @ delta).std(axis=0) + 1e-12
    pi = robot.inertial_parameters + delta.reshape(robot.n, 10)
    if (pi[:, 0] <= 0).any():
        return nominal
    return replace(
        nominal,
        robot=robot.with_inertial_parameters(pi),
        others=replace(nominal.others, robot=robot.with_inertial_parameters(pi)),
    )


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


def _scales(robot: RobotModel) -> Array:
    """Return the size of error that would surprise nobody, for every inertial parameter, shape (10 n,)."""
    rows = []
    for p in robot.inertial_parameters:
        mass = max(p[0], 1e-3)
        reach = max(float(np.linalg.norm(p[1:4])) / mass, REACH)
        rows.append([mass, *[mass * reach] * 3, *[mass * reach**2] * 6])
    return SURPRISING * np.concatenate(rows)
