"""The sampling of a log: rate, gaps, jitter, repeated samples, resolution."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.joint_units import units_of
from cdia_pin.logs.checks.motion import (
    CUTOFF,
    SHORTEST,
    SmoothedMotion,
    longest_stretch,
)
from cdia_pin.logs.derivatives import speed_of
from cdia_pin.logs.log import Log
from cdia_pin.logs.recorded_parts import LONGEST_GAP
from cdia_pin.logs.resolution import quantum
from cdia_pin.phrases import counted

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

LOWEST_RATE = 40.0  # [Hz], accelerations of an arm cannot be derived at a lower rate
LONG_GAP = 0.1  # [s], an arm's acceleration can change sign in this time
SPREAD = (5, 95)  # [%] of the steps between samples that tell whether a clock is even
EVEN = 0.05  # [1], range of those steps over a period up to which it is
FROZEN = 0.25  # [s], a measured signal of a moving joint changes in less than this time


def check_rate(log: Log) -> Iterator[Finding]:
    """Report the rate and the length of a log.

    Args:
        log: The log.

    Yields:
        One finding.
    """
    value = {"rate_hz": log.rate, "samples": len(log.time), "duration_s": log.duration}
    message = f"{len(log.time)} samples in {log.duration:.4g} s, {log.rate:.4g} Hz (median)"
    if log.rate < LOWEST_RATE:
        yield Finding(
            Topic.RATE,
            Severity.WARNING,
            f"{message}: too slow to derive accelerations",
            advice=f"record at {LOWEST_RATE:g} Hz or more; check the unit of time (--convert time=ms)",
            value=value,
        )
    elif log.duration < SHORTEST:
        yield Finding(
            Topic.RATE, Severity.WARNING, f"{message}: too short", advice="record 10 s or more", value=value
        )
    else:
        yield Finding(Topic.RATE, Severity.OK, message, value=value)


def check_gaps(log: Log) -> Iterator[Finding]:
    """Report gaps between samples, and the jitter of the other steps.

    Args:
        log: The log.

    Yields:
        One finding on gaps and one on jitter.
    """
    step, period, even = np.diff(log.time), 1.0 / log.rate, has_even_clock(log)
    gaps = np.flatnonzero(step > 5.0 * period)
    if len(gaps):
        longest = float(step[gaps].max())
        at = float(log.time[gaps[step[gaps].argmax()]])
        left_out = len(log.time) - len(longest_stretch(log).time)
        said = f"{longest:.3g} s" if longest >= 1.0 else f"{longest * 1e3:.3g} ms"
        split = (
            f"; of the parts without a gap over {LONGEST_GAP:g} s only the longest is checked further "
            f"({left_out} samples are not), other commands use them all"
        )
        yield Finding(
            Topic.GAPS,
            Severity.WARNING if longest > LONG_GAP else Severity.INFO,
            f"{counted(len(gaps), 'gap')}, the longest {said} after t = {at:.4g} s"
            + (split if longest > LONGEST_GAP else ""),
            advice="record without gaps: what happened in them is unknown" if longest > LONG_GAP else "",
            value={"count": len(gaps), "longest_s": longest, "after_s": at, "not_checked": left_out},
        )
    else:
        yield _missing_rows(log, step, period, even)
    low, high = np.percentile(step, SPREAD)
    value = {"step_p05_s": float(low), "step_p95_s": float(high), "step_std_s": float(step.std())}
    if not even:
        grid = _time_grid(log.time)
        stamped = f"; stamps are multiples of {grid * 1e3:g} ms" if grid else ""
        yield Finding(
            Topic.JITTER,
            Severity.WARNING if high > 3.0 * period else Severity.INFO,
            f"steps from {low * 1e3:.3g} to {high * 1e3:.3g} ms (5 to 95 %){stamped}; "
            "signals are resampled to a uniform grid before derivatives are taken",
            advice="use the time of measurement as stamp, not the time of writing"
            if high > 3.0 * period
            else "",
            value=value,
        )
    else:
        yield Finding(Topic.JITTER, Severity.OK, "evenly sampled", value=value)


def _missing_rows(log: Log, step: Array, period: float, even: bool) -> Finding:
    """Return the rows that an even clock lacks; a clock that jitters does not tell them."""
    lacking = np.round(step / period).astype(int) - 1
    count = int(lacking.sum())  # a row that is only late lacks at one step and is one too many at the next
    if not even or count <= 0:
        return Finding(Topic.GAPS, Severity.OK, "no gaps", value={"count": 0})
    first = float(log.time[int(np.argmax(lacking > 0))])
    return Finding(
        Topic.GAPS,
        Severity.INFO,
        f"{counted(count, 'row')} missing, the first after t = {first:.4g} s; interpolated where the log is used",
        value={"count": 0, "missing_rows": count, "first_after_s": first},
    )


def has_even_clock(log: Log) -> bool:
    """Return True if the steps between the samples of a log hardly differ, gaps aside.

    Args:
        log: The log.
    """
    low, high = np.percentile(np.diff(log.time), SPREAD)
    return bool(high - low <= EVEN / log.rate)


def check_repeats(log: Log, robot: RobotModel, motion: SmoothedMotion | None) -> Iterator[Finding]:
    """Report repeated samples, and signals that are constant while the joint moves.

    Args:
        log: The log.
        robot: Its robot.
        motion: Smoothed signals, which tell the moving joints; None for a log that is too short.

    Yields:
        One finding on repeated samples, and one per frozen signal.
    """
    signals = [log.position, log.effort] if log.velocity is None else [log.position, log.effort, log.velocity]
    held = np.ones(len(log.time) - 1, dtype=bool)
    for column in (c for s in signals for c in s.T):
        held &= column[1:] == column[:-1]
    share = float(held.mean())
    if share > 0.005:
        source_rate = (1.0 - share) * (len(log.time) - 1) / log.duration
        yield Finding(
            Topic.DUPLICATES,
            Severity.WARNING if source_rate < LOWEST_RATE else Severity.INFO,
            f"{share:.1%} of the samples repeat the one before in every signal: the source updates at about "
            f"{source_rate:.4g} Hz, or the arm stands still without noise",
            value={"share": share, "source_rate_hz": source_rate},
        )
    else:
        yield Finding(Topic.DUPLICATES, Severity.OK, "no repeated samples", value={"share": share})
    if motion is None:
        return
    for k in np.flatnonzero(motion.moves):
        yield from _frozen(log, int(k), *units_of(robot, int(k)))


def _frozen(log: Log, k: int, position_unit: str, effort_unit: str) -> Iterator[Finding]:
    if not np.ptp(log.effort[:, k]):
        yield Finding(
            Topic.FROZEN,
            Severity.ERROR,
            f"the effort is {log.effort[0, k] + 0.0:.4g} {effort_unit} throughout although the joint moves: "
            "it was not recorded",
            joint=log.joints[k],
            advice="record the effort of this joint",
            value={"signal": "effort"},
        )
        return
    start, stop = longest_run(np.diff(log.effort[:, k]) == 0)
    seconds = float(log.time[stop] - log.time[start])
    travelled = float(np.ptp(log.position[start : stop + 1, k]))
    extreme = log.effort[start, k] in {
        log.effort[:, k].min(),
        log.effort[:, k].max(),
    }  # check_saturation reports that
    if seconds > FROZEN and travelled > 0.05 * np.ptp(log.position[:, k]) and not extreme:
        yield Finding(
            Topic.FROZEN,
            Severity.WARNING,
            f"the effort stands at {log.effort[start, k] + 0.0:.4g} {effort_unit} for {seconds:.3g} s from "
            f"t = {log.time[start]:.4g} s while the joint moves {travelled:.3g} {position_unit}",
            joint=log.joints[k],
            advice="leave that part out of the file, or find out why the effort was not updated",
            value={"signal": "effort", "from_s": float(log.time[start]), "seconds": seconds},
        )
    if log.velocity is None:
        return
    start, stop = longest_run(np.diff(log.position[:, k]) == 0)
    seconds = float(log.time[stop] - log.time[start])
    fastest = float(np.abs(log.velocity[start : stop + 1, k]).min())
    if seconds > FROZEN and fastest > 0.1 * max(float(speed_of(log.position[:, k], log.time).max()), 1e-9):
        yield Finding(
            Topic.FROZEN,
            Severity.WARNING,
            f"the position stands still for {seconds:.3g} s from t = {log.time[start]:.4g} s while "
            f"the recorded velocity is at least {fastest:.3g} {position_unit}/s",
            joint=log.joints[k],
            advice="leave that part out of the file, or find out why the position was not updated",
            value={"signal": "position", "from_s": float(log.time[start]), "seconds": seconds},
        )


def check_resolution(log: Log, robot: RobotModel, motion: SmoothedMotion | None) -> Iterator[Finding]:
    """Report the rounding of positions and efforts, and the noise in torque that it causes.

    Args:
        log: The log.
        robot: Its robot, whose inertia turns acceleration into torque.
        motion: Smoothed signals; None for a log that is too short.

    Yields:
        A finding per signal with noticeable rounding.
    """
    if motion is None:
        return
    inertia = np.diagonal(robot.mass_matrix(motion.thin(20).q), axis1=1, axis2=2).max(axis=0)
    # White noise of step/√12 through a low-pass at CUTOFF, differentiated twice [1/s²].
    amplify = (2 * np.pi * CUTOFF) ** 2 * np.sqrt(CUTOFF / (2.5 * log.rate)) / np.sqrt(12)
    rounded = {
        "position": (log.position, amplify * inertia),
        "effort": (log.effort, np.full(robot.n, 1 / np.sqrt(12))),
    }
    for signal, (values, torque_per_step) in rounded.items():
        steps, shares = {}, {}
        for k in np.flatnonzero(motion.moves).tolist():
            step, effort = quantum(values[:, k]), float(motion.effort[:, k].std())
            if step > 0 and effort > 0:
                steps[log.joints[k]] = step
                shares[log.joints[k]] = float(step * torque_per_step[k]) / effort
        if not steps or max(shares.values()) < 1e-3:
            continue
        worst = max(shares, key=lambda joint: shares[joint])
        coarsest = max(steps, key=lambda joint: steps[joint])
        unit = units_of(robot, log.joints.index(coarsest))[signal == "effort"]
        yield Finding(
            Topic.RESOLUTION,
            Severity.WARNING if shares[worst] > 0.1 else Severity.INFO,
            f"{signal}s of {counted(len(steps), 'joint')} are rounded, on {coarsest} to multiples of "
            f"{steps[coarsest]:.2g} {unit}: a noise in torque of up to {shares[worst]:.1%} of the effort ({worst})",
            advice=f"record {signal}s with more digits" if shares[worst] > 0.1 else "",
            value={"signal": signal, "quantum": steps, "share_of_effort": shares},
        )


def runs(true: NDArray[np.bool_]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Find all runs of True.

    Args:
        true: Flags, shape (N,).

    Returns:
        First index and index after the last of each run, shape (R,) each.
    """
    edge = np.diff(np.concatenate([[0], true.astype(np.int8), [0]]))
    return np.flatnonzero(edge == 1), np.flatnonzero(edge == -1)


def longest_run(true: NDArray[np.bool_]) -> tuple[int, int]:
    """Find the longest run of True.

    Args:
        true: Flags, shape (N,).

    Returns:
        First index and index after the last; (0, 0) if no flag is True.
    """
    starts, stops = runs(true)
    if not len(starts):
        return 0, 0
    longest = int((stops - starts).argmax())
    return int(starts[longest]), int(stops[longest])


def _time_grid(time: Array) -> float:
    """Return the largest of the usual clock periods of which all times are multiples [s]; 0 if none."""
    since = time - time[0]
    for grid in (0.01, 0.005, 0.004, 0.002, 0.001):
        cycles = since / grid
        if np.mean(np.abs(cycles - np.round(cycles)) < 1e-3) > 0.98:
            return grid
    return 0.0
