"""What of a log a monitor may learn from, where nobody gives it runs of the healthy arm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cdia_pin.errors import LogError
from cdia_pin.logs.log import Log

SHARE, LEAST, MOST = 0.3, 5.0, 20.0  # [1, s, s], of a log that is taken as healthy


def parted(log: Log, until: float | None = None) -> tuple[Log, Log]:
    """Part a log into what is taken as healthy, and what is monitored.

    Args:
        log: The log.
        until: Length of the healthy part [s]; 30 %, 5 to 20 s, if omitted.

    Raises:
        LogError: If one of the parts would be empty.
    """
    length = until
    if length is None:
        length = min(max(SHARE * log.duration, LEAST), MOST)
    begin = int((log.time < log.time[0] + length).sum())
    if not 1 < begin < len(log.time) - 1:
        raise LogError(
            f"{log.source}: {log.duration:.3g} s cannot be parted at {length:.3g} s into a healthy part and one to "
            "monitor; give runs of the healthy arm with --healthy"
        )
    return log.slice(0, begin), log.slice(begin, len(log.time))


def alike(logs: Sequence[Log], velocity: bool, announced: list[str]) -> list[Log]:
    """Return logs that all have velocities, or none of them.

    Args:
        logs: The logs.
        velocity: Whether recorded velocities are wanted.
        announced: Where it is said if they are left out.
    """
    have = [log.velocity is not None for log in logs]
    if not any(have) or (velocity and all(have)):
        return list(logs)
    if velocity:
        announced.append("not all logs have velocities: they are derived from the positions of all")
    return [replace(log, velocity=None) for log in logs]
