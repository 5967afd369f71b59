"""Selection of a signal's columns from a table, in the robot's joint order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.columns import ColumnNames, signal_of
from cdia_pin.logs.formats import ColumnChoice
from cdia_pin.logs.formats.choice import TORQUES
from cdia_pin.logs.formats.guess import torques_among
from cdia_pin.logs.joint_names import match_joints
from cdia_pin.logs.named_arms import arms_named_by
from cdia_pin.logs.readers.table import Table
from cdia_pin.phrases import some

Array = NDArray[np.float64]


@dataclass
class SignalPicker:
    """Selects signals from a table and collects notes on its inferences.

    Attributes:
        table: Columns as read.
        choice: The columns of each signal, and what is known of them.
        joints: Joints of the robot.
        joint_map: {name in the log: joint of the robot}.
        source: Name of the log, for messages.
        notes: Sentences on inferences; signals that are selected add more.
        used: Joint labels of the log that were used; signals that are selected add more.
    """

    table: Table
    choice: ColumnChoice
    joints: Sequence[str]
    joint_map: Mapping[str, str]
    source: str
    notes: list[str]
    used: set[str] = field(default_factory=set)

    def required(self, signal: str) -> Array:
        """Return a signal that the log must have.

        Args:
            signal: ``position``, ``velocity``, ``effort`` or ``current``.

        Returns:
            Values [as logged], shape (N, n).

        Raises:
            LogError: If the log lacks it for a joint; the message names what is missing.
        """
        labels = self.columns.labels(signal)
        if not labels:
            raise LogError(f"{self.missing(signal)}; found {self.found}")
        mine = {label: joint for label, joint in self.joint_map.items() if label in labels}
        try:
            found = match_joints(list(labels), self.joints, mine)
        except LogError as error:
            arms = arms_named_by(list(labels))
            hint = f"; its joints are those of {' or '.join(arms)} (--robot {arms[0]})" if arms else ""
            raise LogError(f"{self.source}: {signal}: {error}{hint}") from None
        if found.note and found.note not in self.notes:
            self.notes.append(found.note)
        for name in self.columns.repeated:
            if signal_of(name) in {(signal, label) for label in found.labels}:
                raise LogError(
                    f"{self.source}: column '{name}' holds the {signal} of a joint that another column has"
                )
        self.used.update(found.labels)
        return self.table.stack([labels[label] for label in found.labels], self.source)

    def missing(self, signal: str) -> str:
        """Say that a signal has no columns, and what its format has for it.

        Args:
            signal: ``position``, ``velocity``, ``effort``, ``current`` or ``time``.
        """
        format_ = self.choice.format
        if signal == "time":
            return f"{self.source}: no column 'time' [s]; rows at an even pace need none: --convert rate=100 [Hz]"
        if format_.advice:
            return f"{self.source}: no {signal} columns of format '{format_.name}'; {format_.advice}"
        return f"{self.source}: no {signal} columns; expected {signal}.{self.joints[0]} and so on"

    @property
    def found(self) -> str:
        """The columns of the file, in words."""
        return some([*self.table.columns, *self.table.not_numbers])

    def optional(self, signal: str) -> Array | None:
        """Return a signal that the log may lack.

        Args:
            signal: ``position``, ``velocity``, ``effort`` or ``current``.

        Returns:
            Values [as logged], shape (N, n); None, with a note, if a joint lacks it or it is empty.
        """
        if not self.columns.labels(signal):
            self.notes.append(f"no {signal} recorded; it is derived from the positions if needed")
            return None
        try:
            values = self.required(signal)
        except LogError as error:
            self.notes.append(f"{signal} not used, because not every joint has it ({error})")
            return None
        if np.isnan(values).all(axis=0).any():
            self.notes.append(
                f"{signal} not used, because it is empty (NaN throughout) for at least one joint"
            )
            return None
        return values

    def time(self) -> NDArray[Any]:
        """Return the times as logged, shape (N,); raises LogError if there are none."""
        name = self.columns.time_column
        if name is None:
            raise LogError(f"{self.missing('time')}; found {self.found}")
        if name in self.table.not_numbers:
            raise LogError(
                f"{self.source}: column '{name}' must hold times, found {self.table.not_numbers[name]}"
            )
        return self.table.columns[name]

    def note_what_was_ignored(self) -> None:
        """Note the joints of the log that the robot does not have, and other columns that may be its torques."""
        extra = [label for label in self.labels if label not in self.used]
        if extra:
            self.notes.append(f"joints of the log that the robot does not have, ignored: {some(extra)}")
        read = next((s for s in TORQUES if self.columns.labels(s)), None)
        others = torques_among(self.columns.other, len(self.joints))
        if read is not None and others and not TORQUES.keys() & self.choice.recorded.keys():
            first = next(iter(self.columns.labels(read).values()))
            self.notes.append(
                f"{read} read from '{first}' and so on; other columns may be torques too: {some(others)} "
                f"(--columns {read}=… changes it)"
            )

    @property
    def columns(self) -> ColumnNames:
        """The columns by signal and joint label."""
        return self.choice.columns

    @property
    def labels(self) -> list[str]:
        """Joint labels of the log, over all signals."""
        return list(dict.fromkeys(name for labels in self.columns.signals.values() for name in labels))
