"""Parts of logs: the healthy part, if there are no runs of the healthy arm, and the halves of healthy motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.log import Log

HEALTHY_SHARE = 0.3  # [1], share of a log's motion that is taken as healthy
LEAST_HEALTHY = 5.0  # [s] of motion; from less, thresholds come out too low
MOST_HEALTHY = 20.0  # [s] of motion; more teaches little, and hides faults that begin early
MOVED_IN = 0.2  # [s], within which a joint in motion travels more than `LEAST_MOVED`
LEAST_MOVED = 1e-3  # [rad or m], several steps of usual encoders; slower than 5 mrad/s is rest


def parted(log: Log, until: float | None = None) -> tuple[Log, Log]:
    """Return the part of a log that is taken as healthy, and the part to monitor.

    Args:
        log: The log.
        until: Length of the healthy part [s]. If omitted, it holds 30 % of the time in which the arm moves, 5 to 20 s
            of it: an arm at rest teaches neither its friction nor how fast it moves.

    Raises:
        LogError: If one of the parts would be empty.
    """
    begin = _healthy_samples(log) if until is None else int((log.time < log.time[0] + until).sum())
    if not 1 < begin < len(log.time) - 1:
        where = f"at {until:.6g} s" if until is not None else f"after {LEAST_HEALTHY:g} s of motion"
        raise LogError(
            f"{log.source}: {log.duration:.6g} s cannot be split {where} into a healthy part and a part to monitor; "
            "give runs of the healthy arm with --healthy, or the length of the healthy part with --healthy-until"
        )
    return log.slice(0, begin), log.slice(begin, len(log.time))


def _healthy_samples(log: Log) -> int:
    """Return the number of samples that hold enough motion; all or more if there is too little."""
    moving = np.cumsum(motion(log).any(axis=1)) / log.rate  # [s]
    healthy = min(max(HEALTHY_SHARE * moving[-1], LEAST_HEALTHY), MOST_HEALTHY)
    return int(np.searchsorted(moving, healthy)) + 1


def motion(log: Log) -> NDArray[np.bool_]:
    """Return in which samples each joint moves, shape (K, n).

    An encoder that flickers at rest does not move; one that is too rough to tell always seems to.

    Args:
        log: The log.
    """
    half = max(1, round(0.5 * MOVED_IN * log.rate))
    if len(log.time) <= 2 * half:
        return np.zeros(log.position.shape, bool)
    travel = np.abs(log.position[2 * half :] - log.position[: -2 * half])
    return np.pad(travel > LEAST_MOVED, ((half, half), (0, 0)), mode="edge")


def halves(runs: Sequence[Log], least: float) -> tuple[tuple[Log, ...], tuple[Log, ...]]:
    """Return the first and the second half of the motion of several runs; at most one run is cut.

    Args:
        runs: Two seconds or more together.
        least: Length of a piece below which nothing is cut [s].
    """
    left = 0.5 * sum(run.duration for run in runs)  # [s], that the first half still lacks
    first: list[Log] = []
    second: list[Log] = []
    for run in runs:
        if left <= least:
            second.append(run)
        elif run.duration - left < least:
            first.append(run)
        else:
            cut = int(np.searchsorted(run.time, run.time[0] + left))
            first.append(run.slice(0, cut))
            second.append(run.slice(cut, len(run.time)))
        left -= run.duration
    return tuple(first), tuple(second)


def alike(logs: Sequence[Log], velocity: bool, announced: list[str]) -> list[Log]:
    """Return logs that either all have velocities or none.

    Args:
        logs: The logs.
        velocity: Whether recorded velocities are used.
        announced: Gets a sentence if recorded velocities are left out.
    """
    have = [log.velocity is not None for log in logs]
    if not any(have) or (velocity and all(have)):
        return list(logs)
    if velocity:
        announced.append("not all logs have velocities: those of all logs are derived from positions")
    return [replace(log, velocity=None) for log in logs]
