"""`EventLogFile`: every event of a monitor as one line of JSON, appended to a file while the arm moves.

The file is opened for each event, so that it may be moved away meanwhile. A line is on it as a whole or not at all:
what a full disk has taken of it is cut off again. Lines that could not be written wait for the next event.
"""

from __future__ import annotations

import json
import os
from collections import deque
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cdia_pin import schemas
from cdia_pin.diagnosis.status import Event
from cdia_pin.errors import ModelError
from cdia_pin.plain_json import plain
from cdia_pin.robot.model import RobotModel
from cdia_pin.whole_files import require_place

MOST_WAITING = 1000  # events that wait for a disk; older ones are lost, and their number is noted


class EventLogFile:
    """A file to which events are appended. Its first line, and the first after each start, names the arm.

    Args:
        path: The file; what it holds stays.
        robot: The arm.

    Raises:
        ModelError: If the file cannot be written now. Later on nothing is raised.
    """

    def __init__(self, path: str | Path, robot: RobotModel) -> None:
        self._path, self._robot = Path(path), robot
        try:
            if self._path.exists() and not self._path.is_file():
                raise OSError(0, "expected a file")
            require_place(self._path)
        except OSError as error:
            raise ModelError(f"cannot write events to {path}: {error.strerror}") from None
        self.warnings: tuple[str, ...] = ()
        self._waiting: deque[str] = deque(maxlen=MOST_WAITING)
        self._lost = 0
        self.begin()

    def begin(self) -> None:
        """Name the arm again before the next event."""
        self._has_begun = False

    def write(self, events: Sequence[Event]) -> None:
        """Append events; if that fails, `warnings` says so, and they are written with the next ones.

        Args:
            events: At least one.
        """
        for event in events:
            self._lost += len(self._waiting) == MOST_WAITING
            self._waiting.append(_line(event.to_dict(self._robot)))
        names = {"robot": self._robot.name, "joints": list(self._robot.joints)}
        first = [] if self._has_begun else [_line({"schema": schemas.EVENT_LOG, **names})]
        lost = [_line({"lost": self._lost})] if self._lost else []
        try:
            self._append("".join([*first, *lost, *self._waiting]).encode(errors="replace"))
        except OSError as error:
            missing = len(self._waiting) + self._lost
            self.warnings = (f"{missing} events are not in the event log: {error.strerror}",)
            return
        self._has_begun = True
        self._waiting.clear()
        self._lost, self.warnings = 0, ()

    def _append(self, text: bytes) -> None:
        with self._path.open("ab", buffering=0) as file:
            size = file.seek(0, os.SEEK_END)
            try:
                while text:
                    text = text[file.write(text) :]
            except OSError:
                file.truncate(size)
                raise


def _line(document: Mapping[str, Any]) -> str:
    return json.dumps(plain(document), ensure_ascii=False, allow_nan=False) + "\n"
