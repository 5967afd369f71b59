"""Comparison of the recorded velocities with the derivative of the positions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.motion import CUTOFF, SmoothedMotion, longest_stretch
from cdia_pin.logs.checks.sampling import has_even_clock
from cdia_pin.logs.checks.uncounted_time import Pauses, uncounted
from cdia_pin.logs.derivatives import uniform, zero_phase
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

LAGS = 0.1  # [s], largest lag that is tried, late or early
DEGREE = np.pi / 180.0  # [rad]
# Largest factor on a joint over the smallest, less one [1], below which all joints have one factor, as times that run
# too fast give them. It is 0.010 to 0.014 in three logs of a measured arm whose times run five times too fast, and
# 0.08 and more in seven logs of a KUKA whose velocities were filtered: 0.02 and 0.07 decide all ten as 0.05 does.
ONE_FACTOR = 0.05  # [1]
_LEAVE_OUT = "ignore the recorded velocities: --convert use_velocity=false"


@dataclass(frozen=True)
class VelocityMatch:
    """The fit: recorded velocity ≈ scale · dq/dt(t − lag).

    Attributes:
        scale: Recorded over derived velocity [1].
        lag: How much later the recorded velocity is [s].
        unexplained: Share of the recorded velocity's variance that the fit leaves [1].
    """

    scale: float
    lag: float
    unexplained: float


@dataclass(frozen=True)
class Mismatch:
    """A reason why recorded velocities are not the derivative of the positions.

    Attributes:
        severity: Severity of the finding.
        meaning: Predicate of the message, after "the recorded velocity".
        advice: Advice, with the field {joints}.
        misleads: Whether times or positions are at fault too, not the recorded velocity alone.
    """

    severity: Severity
    meaning: str
    advice: str
    misleads: bool = False


_SCALED = Mismatch(Severity.WARNING, "is a multiple of the derivative of the position", _LEAVE_OUT)
_KNOWN = {
    -1.0: Mismatch(
        Severity.ERROR, "has the opposite sign of the derivative", "--convert flip_velocity={joints}"
    ),
    1 / DEGREE: Mismatch(Severity.ERROR, "is in degrees/s while the position is in rad", _LEAVE_OUT),
    DEGREE: Mismatch(
        Severity.ERROR,
        "is in rad/s while the position is in degrees",
        "--convert angle=deg --convert use_velocity=false",
        misleads=True,
    ),
    1e3: Mismatch(
        Severity.ERROR,
        "is 1000 times the derivative: times are in ms, not s",
        "--convert time=ms",
        misleads=True,
    ),
    1e6: Mismatch(
        Severity.ERROR,
        "is a million times the derivative: times are in µs, not s",
        "--convert time=us",
        misleads=True,
    ),
    1e-3: Mismatch(
        Severity.ERROR,
        "is a 1000th of the derivative: times are in s, not ms",
        "--convert time=s",
        misleads=True,
    ),
}
"""Known reasons, by the ratio of recorded to derived velocity."""


def check_velocity(log: Log, motion: SmoothedMotion | None) -> Iterator[Finding]:
    """Compare recorded velocities with the derivative of the positions: pauses of the recorder, sign, scale, lag.

    Args:
        log: The log.
        motion: Smoothed signals, which tell the moving joints; None for a log that is too short.

    Yields:
        A finding per kind of difference, and one on the lag of the others.
    """
    if log.velocity is None:
        yield Finding(Topic.VELOCITY, Severity.INFO, "not recorded; derived from the positions")
        return
    if motion is None or not motion.moves.any():
        why = "the log is too short" if motion is None else "no joint moves"
        yield Finding(Topic.VELOCITY, Severity.INFO, f"cannot compare velocities with positions: {why}")
        return
    moving = [int(k) for k in np.flatnonzero(motion.moves)]
    zero = [log.joints[k] for k in moving if not log.velocity[:, k].any()]
    if zero:
        yield Finding(
            Topic.VELOCITY,
            Severity.ERROR,
            f"recorded as zero although the joint moves: {', '.join(zero)}",
            advice=_LEAVE_OUT,
            value={"joints": zero},
            misleads=False,
        )
    told = [k for k in moving if log.velocity[:, k].any()]
    pauses = uncounted(log, told)
    if pauses is not None:
        yield _pauses(log, pauses)
        return
    matches = _matches(log, told)
    odd = {k: m for k, m in matches.items() if abs(m.scale - 1.0) > 0.03 or m.unexplained > 0.02}
    alike: dict[Mismatch, list[int]] = {}
    for k, match in odd.items():
        alike.setdefault(_cause(match), []).append(k)
    if len(odd) == len(matches) and set(alike) == {_SCALED} and _have_one_factor(matches):
        yield _times_or_unit(log, matches)
        return
    for cause, where in alike.items():
        names = [log.joints[k] for k in where]
        places = (
            names
            if cause is not _SCALED
            else [f"{log.joints[k]} ({matches[k].scale:.3g} times)" for k in where]
        )
        yield Finding(
            Topic.VELOCITY,
            cause.severity,
            f"the recorded velocity {cause.meaning} on {', '.join(places)}",
            joint=names[0] if len(names) == 1 else None,
            advice=cause.advice.format(joints=",".join(names)),
            value={log.joints[k]: asdict(matches[k]) for k in where},
            misleads=cause.misleads,
        )
    fine = {k: m for k, m in matches.items() if k not in odd}
    if fine:
        of = f" of {', '.join(log.joints[k] for k in fine)}" if odd else ""
        yield _lag(np.array([m.lag for m in fine.values()]), log.rate, len(fine), of)


def _pauses(log: Log, pauses: Pauses) -> Finding:
    """Return the finding on pauses that the times do not count."""
    return Finding(
        Topic.VELOCITY,
        Severity.ERROR,
        f"the times leave out {pauses.number} pauses or more, of {pauses.usual:.3g} s mostly: between rows the joints "
        f"travel many times as far as their velocities say; {pauses.lost:.3g} s in all beside {log.duration:.3g} s",
        advice="record the time of each row with the controller's clock, not by counting rows; no conversion mends it",
        value=pauses._asdict(),
    )


def _have_one_factor(matches: Mapping[int, VelocityMatch]) -> bool:
    scales = [m.scale for m in matches.values()]
    return len(scales) > 1 and min(scales) > 0.0 and max(scales) / min(scales) - 1.0 < ONE_FACTOR


def _times_or_unit(log: Log, matches: Mapping[int, VelocityMatch]) -> Finding:
    """Return the finding on velocities that are one multiple of the derivative on all joints that move."""
    factor = float(np.median([m.scale for m in matches.values()]))
    often = f"{1 / factor:.3g} times too fast" if factor < 1 else f"{factor:.3g} times too slow"
    lasted = float(np.ptp(log.time))
    mend = (
        f": --convert rate={log.rate * factor:.4g}"
        if has_even_clock(log)
        else f", multiply its times by {1 / factor:.3g}"
    )
    return Finding(
        Topic.VELOCITY,
        Severity.WARNING,
        f"the recorded velocity is {factor:.3g} times the derivative of the position on all {len(matches)} joints that "
        f"move: the times run {often}, or velocities have another unit",
        advice=f"if the log lasted {lasted / factor:.3g} s by the clock, not {lasted:.3g} s{mend}; "
        f"otherwise {_LEAVE_OUT}",
        value={log.joints[k]: asdict(m) for k, m in matches.items()},
    )


def _matches(log: Log, joints: list[int]) -> dict[int, VelocityMatch]:
    even = uniform(longest_stretch(log))
    assert even.velocity is not None
    rate = even.rate
    cutoff = min(CUTOFF, 0.2 * rate)
    derived = zero_phase(even.position[:, joints], cutoff, rate, derivative=1)
    recorded = zero_phase(even.velocity[:, joints], cutoff, rate)
    edge = int((1.0 / cutoff + LAGS) * rate) + 2
    index = np.arange(edge, len(even.time) - edge, max(1, int(rate // (5 * cutoff))))
    lags = np.linspace(-LAGS, LAGS, 201)
    out = {}
    for column, k in enumerate(joints):
        x = derived[index, column]
        later = np.column_stack(
            [np.interp(even.time[index] + lag, even.time, recorded[:, column]) for lag in lags]
        )
        scale = x @ later / (x @ x)
        left = ((later - np.outer(x, scale)) ** 2).sum(axis=0) / (later**2).sum(axis=0)
        best = int(left.argmin())
        out[k] = VelocityMatch(float(scale[best]), vertex(lags, left), float(left[best]))
    return out


def vertex(grid: Array, cost: Array) -> float:
    """Find the minimum of a sampled cost, refined by the parabola through its neighbours.

    Args:
        grid: Equally spaced arguments, shape (K,).
        cost: Cost at each argument, shape (K,).

    Returns:
        Argument of the minimum, in the unit of the grid.
    """
    best = int(cost.argmin())
    if best in {0, len(grid) - 1}:
        return float(grid[best])
    left, centre, right = cost[best - 1 : best + 2]
    bend = left - 2 * centre + right
    offset = 0.5 * (left - right) / bend if bend > 0 else 0.0
    return float(grid[best] + offset * (grid[1] - grid[0]))


def _cause(match: VelocityMatch) -> Mismatch:
    """Name the reason why a recorded velocity differs from the derivative of the position."""
    if match.unexplained > 0.3:
        return Mismatch(
            Severity.WARNING,
            "does not follow the derivative of the position",
            f"check the order of the columns, or {_LEAVE_OUT}",
        )
    for factor, cause in _KNOWN.items():
        if abs(match.scale / factor - 1.0) < 0.05:
            return cause
    if abs(match.scale - 1.0) <= 0.03:
        return Mismatch(
            Severity.INFO, "follows the derivative of the position but for noise or a filter", _LEAVE_OUT
        )
    return _SCALED


def _lag(lags: Array, rate: float, count: int, of: str) -> Finding:
    lag = float(np.median(lags))
    value = {"lag_s": lag, "spread_s": float(np.ptp(lags)), "joints": count}
    if abs(lag) > max(1.5 / rate, 2e-3):
        by = f"{LAGS * 1e3:.0f} ms or more" if abs(lag) >= LAGS else f"{abs(lag) * 1e3:.1f} ms"
        when = "late (a filter, usually)" if lag > 0 else "early"
        return Finding(
            Topic.VELOCITY,
            Severity.WARNING if abs(lag) > 10e-3 else Severity.INFO,
            f"recorded velocities{of} fit the positions but are {by} {when}",
            advice=_LEAVE_OUT,
            value=value,
        )
    return Finding(
        Topic.VELOCITY,
        Severity.OK,
        f"recorded velocities{of} are the derivative of the positions",
        value=value,
    )
