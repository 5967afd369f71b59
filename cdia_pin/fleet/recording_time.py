"""When a log was recorded: from the user, from its clock, or from its name and those of its folders."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import StrEnum

from cdia_pin.logs.log import Log

# 2026-05-12, 20260512, folders 2026/05/12, each with 14-30, 14:30:05, T143005 behind it or nothing
DATE = r"(?<!\d)(20\d\d)([-_./]?)(0[1-9]|1[0-2])\2(0[1-9]|[12]\d|3[01])"
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


def recording_time(
    log: Log | None, name: str, stated: datetime | None = None, folders: Sequence[str] = ()
) -> RecordingTime:
    """Return when a log was recorded: what the user states counts before its clock, and the clock before names.

    Args:
        log: The log; None if it could not be read.
        name: Name of its file.
        stated: What the user's map states.
        folders: Names of the folders that tell it from other logs, the outermost first. The nearest one with a date
            counts where the file's name has none; a date may also be spread over several.

    Returns:
        Times without a zone are taken as UTC.
    """
    if stated is not None:
        return RecordingTime(_utc(stated), TimeSource.MAP)
    if log is not None and log.recorded is not None:
        return RecordingTime(datetime.fromtimestamp(log.recorded, UTC), TimeSource.LOG)
    dates = map(_date_in, (name, *reversed(folders), "/".join((*folders, name))))
    at = next((at for at in dates if at is not None), None)
    return RecordingTime(at, TimeSource.ABSENT if at is None else TimeSource.NAME)


def _date_in(name: str) -> datetime | None:
    found = IN_NAME.search(name)
    if found is None:
        return None
    year, _, month, day, hour, minute, second = found.groups()
    try:
        at = datetime(int(year), int(month), int(day), int(hour or 0), int(minute or 0), int(second or 0))
    except ValueError:  # such as the 31st of a month of 30 days
        return None
    return _utc(at)


def _utc(at: datetime) -> datetime:
    return at.replace(tzinfo=UTC) if at.tzinfo is None else at.astimezone(UTC)
