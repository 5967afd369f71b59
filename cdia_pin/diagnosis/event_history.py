"""`EventHistory`: the events of a monitor, the last of them in memory and all of them on disk if asked."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from pathlib import Path

from cdia_pin.diagnosis.event_log_file import EventLogFile
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.status import Event
from cdia_pin.robot.model import RobotModel

# An arm in use has some tens of events a day, one that is diagnosed some hundreds; a thousand take some megabytes.
MOST_EVENTS = 1000  # events that are kept in memory [1]


class EventHistory(Stateful):
    """The last events, the latest last.

    Args:
        file: Gets every event; None for none.

    Attributes:
        events: The last `MOST_EVENTS` events.
    """

    STATE = ("events",)

    def __init__(self, file: EventLogFile | None = None) -> None:
        self._file = file
        self.events: deque[Event] = deque(maxlen=MOST_EVENTS)

    @classmethod
    def to(cls, path: str | Path | None, robot: RobotModel) -> EventHistory:
        """Return a history without events that writes to a file.

        Args:
            path: The file; None for none.
            robot: The arm.

        Raises:
            ModelError: If the file cannot be written now.
        """
        return cls(None if path is None else EventLogFile(path, robot))

    def reset(self) -> None:
        """Forget the events; what is on disk stays."""
        self.events.clear()
        if self._file is not None:
            self._file.begin()

    def add(self, events: Sequence[Event]) -> None:
        """Add events; nothing is raised.

        Args:
            events: The events of a tick.
        """
        self.events += events
        if self._file is not None and events:
            self._file.write(events)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Why events are missing on disk; empty if none are."""
        return () if self._file is None else self._file.warnings
