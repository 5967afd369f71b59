"""Parts of logs: the healthy part, if there are no runs of the healthy arm, and the halves of healthy motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cdia_pin.errors import LogError
from cdia_pin.logs.log import Log

HEALTHY_SHARE = 0.3  # [1], share of a log that is taken as healthy
LEAST_HEALTHY = 5.0  # [s]; from less, thresholds come out too low
MOST_HEALTHY = 20.0  # [s]; more teaches little, and hides faults that begin early


def parted(log: Log, until: float | None = None) -> tuple[Log, Log]:
    """Return the part of a log that is taken as healthy, and the part to monitor.

    Args:
        log: The log.
        until: Length of the healthy part [s]; 30 %, 5 to 20 s, if omitted.

    Raises:
        LogError: If one of the parts would be empty.
    """
    length = until
    if length is None:
        length = min(max(HEALTHY_SHARE * log.duration, LEAST_HEALTHY), MOST_HEALTHY)
    begin = int((log.time < log.time[0] + length).sum())
    if not 1 < begin < len(log.time) - 1:
        raise LogError(
            f"{log.source}: {log.duration:.6g} s cannot be split at {length:.6g} s into a healthy part and a part to "
            "monitor; give runs of the healthy arm with --healthy"
        )
    return log.slice(0, begin), log.slice(begin, len(log.time))


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
