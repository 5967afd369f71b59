"""When a log was recorded: from the user, from its clock, or from its name."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import StrEnum

from cdia_pin.logs.log import Log

# 2026-05-12, 20260512, each with 14-30, 14:30:05, T143005 behind it or nothing
DATE = r"(?<!\d)(20\d\d)([-_.]?)(0[1-9]|1[0-2])\2(0[1-9]|[12]\d|3[01])"
CLOCK = r"(?:[T_ -]+([01]\d|2[0-3])[-:._h]?([0-5]\d)(?:[-:._m]?([0-5]\d))?)?(?!\d)"
IN_NAME = re.compile(DATE + CLOCK)


class TimeSource(StrEnum):
    """Where the time of a log comes from."""

    MAP = "map"
    LOG = "log"
    NAME = "name"
    ABSENT = "absent"


@dataclass(frozen=True)
class RecordingTime:
    """When a log was recorded, and how that is known.

    Attributes:
        at: Time in UTC; None where nothing says it.
        source: Where it comes from.
    """

    at: datetime | None
    source: TimeSource


def recording_time(log: Log | None, name: str, stated: datetime | None = None) -> RecordingTime:
    """Return when a log was recorded: what the user states counts before its clock, and the clock before its name.

    Args:
        log: The log; None if it could not be read.
        name: Name of its file.
        stated: What the user's map states.

    Returns:
        Times without a zone are taken as UTC.
    """
    if stated is not None:
        return RecordingTime(_utc(stated), TimeSource.MAP)
    if log is not None and log.recorded is not None:
        return RecordingTime(datetime.fromtimestamp(log.recorded, UTC), TimeSource.LOG)
    if (found := IN_NAME.search(name)) is not None:
        year, _, month, day, hour, minute, second = found.groups()
        try:
            at = datetime(int(year), int(month), int(day), int(hour or 0), int(minute or 0), int(second or 0))
        except ValueError:  # such as the 31st of a month of 30 days
            return RecordingTime(None, TimeSource.ABSENT)
        return RecordingTime(_utc(at), TimeSource.NAME)
    return RecordingTime(None, TimeSource.ABSENT)


def _utc(at: datetime) -> datetime:
    return at.replace(tzinfo=UTC) if at.tzinfo is None else at.astimezone(UTC)
