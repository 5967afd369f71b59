"""The lag of the efforts behind the motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.conventions import Conventions
from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.fit import physical_columns
from cdia_pin.logs.checks.motion import SAMPLES, SmoothedMotion, longest_stretch
from cdia_pin.logs.checks.velocity import vertex
from cdia_pin.logs.derivatives import BLOCK, smooth_motion, uniform, zero_phase
from cdia_pin.logs.jackknife import jackknife_error
from cdia_pin.logs.log import Log

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

SPAN = 0.1  # [s], largest lag that is tried, late or early: more than any drive or network has
LAGS = np.linspace(-SPAN, SPAN, 51)  # [s]
CUTOFFS = (5.0, 15.0)  # [Hz], two, because friction at reversals shifts the estimate with the cut-off
LONGEST = BLOCK  # samples by which the lag of a log is judged [1]: two minutes at 1 kHz hold some ten motions
BLOCKS = 6  # parts of the log that are left out in turn, for the standard error
WIDEST = 0.06  # [s], width of the interval above which it tells nothing: a third of the range that is tried
LEAST = 5e-3  # [s], distance of the interval from zero above which a delay is proved; the cut-off shifts it by less


@dataclass(frozen=True)
class LagEstimate:
    """Lag of the efforts behind the motion.

    Attributes:
        lag: Best value [s], positive where the effort is late.
        low: Lower end of the interval [s].
        high: Upper end [s]. The interval covers joints, parts of the log, two cut-offs, and fits with and
            without rotor inertia.
        joints: Indices of the joints whose rigid-body torque was large enough.
    """

    lag: float
    low: float
    high: float
    joints: tuple[int, ...]


def estimate_lag(log: Log, robot: RobotModel, conventions: Conventions) -> LagEstimate | None:
    """Find the lag at which model torque, friction and offset explain each effort best.

    Joints with mostly friction are left out: friction builds up after a reversal as if it were late.

    Args:
        log: The log.
        robot: Its robot.
        conventions: The right conventions of the log.

    Returns:
        Lag and interval; None if the log is too short or no joint can be used.
    """
    even = _middle(uniform(longest_stretch(log)))
    centres, lows, highs = [], [], []
    timed: set[int] = set()
    for cutoff in CUTOFFS:
        prepared = _prepare(even, robot, conventions, min(cutoff, 0.2 * even.rate))
        if prepared is None:
            return None
        columns, later, moves = prepared
        for inertia in (False, True):
            fits = {
                k: _joint_lag(columns[k] if inertia else columns[k][:, :4], later[:, :, k])
                for k in np.flatnonzero(moves).tolist()
            }
            usable = {k: f for k, f in fits.items() if f is not None}
            if not usable:
                continue
            timed |= set(usable)
            values = np.array([f[0] for f in usable.values()])
            middle = float(np.median(values))
            scatter = 1.48 * float(np.median(np.abs(values - middle)))
            own = float(np.median([f[1] for f in usable.values()]))
            error = np.hypot(scatter, own) / np.sqrt(len(values))
            centres.append(middle)
            lows.append(middle - 2 * error)
            highs.append(middle + 2 * error)
    if not centres:
        return None
    return LagEstimate(float(np.median(centres)), min(lows), max(highs), tuple(sorted(timed)))


def check_lag(log: Log, robot: RobotModel, conventions: Conventions) -> Iterator[Finding]:
    """Report the lag with its interval, and the effects that look like a lag.

    Args:
        log: The log.
        robot: Its robot.
        conventions: The right conventions of the log.

    Yields:
        One finding on the lag.
    """
    estimate = estimate_lag(log, robot, conventions)
    if estimate is None:
        yield Finding(
            Topic.LAG,
            Severity.INFO,
            "cannot determine the lag of the efforts: no joint has enough rigid-body torque",
        )
        return
    value = {
        "lag_s": estimate.lag,
        "interval_s": [estimate.low, estimate.high],
        "joints": [log.joints[k] for k in estimate.joints],
    }
    nearest_zero = max(estimate.low, -estimate.high, 0.0)
    if estimate.high - estimate.low > WIDEST:
        yield Finding(
            Topic.LAG,
            Severity.INFO,
            "cannot determine the lag of the efforts: with this motion they may be anything from "
            f"{_when(max(estimate.low, -SPAN))} to {_when(min(estimate.high, SPAN))}",
            value=value,
        )
        return
    said = f"{_when(estimate.lag)} (between {_when(estimate.low)} and {_when(estimate.high)})"
    least = max(LEAST, 1.0 / log.rate)
    if nearest_zero > least:
        yield Finding(
            Topic.LAG,
            Severity.WARNING,
            f"the efforts are {said}; a delay, viscous friction and rotor inertia look alike unless speeds and "
            "accelerations vary",
            advice="test it as an effect: cdia add effort_delay LOG; or correct the stamps",
            value=value,
        )
    else:
        yield Finding(
            Topic.LAG,
            Severity.INFO,
            f"the efforts are {said}: no delay above {1e3 * least:.1f} ms is proved; so small a delay looks like "
            "viscous friction or rotor inertia",
            value=value,
        )


def _when(lag: float) -> str:
    """Return a lag [s] in words: ``3.1 ms late``, ``26.4 ms early`` or ``on time``."""
    ms = round(1e3 * lag, 1)
    return f"{abs(ms):g} ms {'late' if ms > 0 else 'early'}" if ms else "on time"


def _middle(even: Log) -> Log:
    """Return the middle of a long log, because a lag is the same all along."""
    start = (len(even.time) - LONGEST) // 2
    return even if start <= 0 else even.slice(start, start + LONGEST)


def _prepare(
    even: Log, robot: RobotModel, conventions: Conventions, cutoff: float
) -> tuple[Array, Array, NDArray[np.bool_]] | None:
    """Compute the physical columns (n, N, 5), the efforts at every lag (N, lags, n) and the moving joints (n,)."""
    rate = even.rate
    edge = int((1.0 / cutoff + SPAN) * rate) + 2
    if len(even.time) < 2 * edge + 60:
        return None
    index = np.arange(edge, len(even.time) - edge, max(1, (len(even.time) - 2 * edge) // SAMPLES))
    q, v, a = smooth_motion(even.position, cutoff, rate)
    effort = zero_phase(even.effort, cutoff, rate)
    still = np.where(robot.is_prismatic, 0.01, 0.05)
    motion = SmoothedMotion(
        time=even.time[index],
        q=q[index],
        v=v[index],
        a=a[index],
        effort=effort[index],
        moves=np.ptp(q[index], axis=0) > still,
    )
    read = conventions.apply(motion, robot)
    shift = LAGS * rate
    later = np.empty((len(index), len(LAGS), robot.n))
    for number, samples in enumerate(shift):
        whole = int(np.floor(samples))
        part = samples - whole
        moved = (1 - part) * effort[index + whole] + part * effort[index + whole + 1]
        later[:, number] = conventions.apply(replace(motion, effort=moved), robot).effort
    return physical_columns(read, robot), later, read.moves


def _joint_lag(columns: Array, later: Array) -> tuple[float, float] | None:
    """Fit the lag of one joint and its standard error [s]; None if rigid-body torque explains too little."""
    x = np.column_stack([columns, np.ones(len(columns))])
    full = _left(x, later)
    best = int(full.argmin())
    without = _left(x[:, 2:], later[:, best : best + 1])[0]
    if full[best] > 0.5 * without or best in {0, len(LAGS) - 1}:
        return None
    parts = np.array_split(np.arange(len(x)), BLOCKS)
    left_out = np.array(
        [vertex(LAGS, _left(np.delete(x, p, axis=0), np.delete(later, p, axis=0))) for p in parts]
    )
    return vertex(LAGS, full), float(jackknife_error(left_out))


def _left(x: Array, y: Array) -> Array:
    """Return the residual sum of squares of every column of y regressed on the columns of x."""
    basis, _ = np.linalg.qr(x / np.maximum(np.sqrt((x * x).sum(axis=0)), 1e-12))
    return np.asarray((y**2).sum(axis=0) - ((basis.T @ y) ** 2).sum(axis=0))
