"""What a format is: the quantities it records, the names of their columns, and what to know about their numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cdia_pin.logs.effort_origin import EffortOrigin
from cdia_pin.logs.formats.patterns import labels_of
from cdia_pin.logs.torque_side import TorqueSide


@dataclass(frozen=True)
class Recorded:
    """A quantity that a format records for each joint.

    Attributes:
        signal: Signal that it is, one of ``ALIASES``.
        patterns: Names of its columns; ``#`` is the number of a joint, ``*`` its name.
        side: Side of the gear on which a torque was measured, if the format tells.
        without_gravity: Whether the controller took gravity away from a torque.
        commanded: Whether it is what a controller asked for.
        unit_stated: Whether the format fixes the unit; if not, the user is asked.
        only_on_request: Whether it is used only where the user names its columns.
        caveat: What to know about the numbers, a sentence; empty if there is nothing.
    """

    signal: str
    patterns: tuple[str, ...]
    side: TorqueSide = TorqueSide.UNKNOWN
    without_gravity: bool = False
    commanded: bool = False
    unit_stated: bool = True
    only_on_request: bool = False
    caveat: str = ""

    @property
    def origin(self) -> EffortOrigin:
        """Where an effort of this kind comes from."""
        if self.commanded:
            return EffortOrigin.COMMANDED
        return EffortOrigin.COMPENSATED if self.without_gravity else EffortOrigin.MEASURED

    def columns(self, names: Sequence[str]) -> dict[str, str]:
        """Find its columns.

        Args:
            names: Names of the columns of a file.

        Returns:
            The column of each joint label, of the first pattern that matches; empty if none does.
        """
        return next((found for p in self.patterns if (found := labels_of(p, names))), {})


@dataclass(frozen=True)
class LogFormat:
    """A format of logs.

    Attributes:
        name: Name that ``--format`` takes.
        description: What writes it, in a few words.
        recorded: Its quantities; of several for one signal the first one that a file has is used. Without any, columns
            are named as in the project's own dialect.
        marks: Patterns of columns that no other format has, by which it is recognised.
        time: Columns of times, with their unit; the unit is inferred where it is None.
        advice: What to record, said where a signal is missing.
    """

    name: str
    description: str
    recorded: tuple[Recorded, ...] = ()
    marks: tuple[str, ...] = ()
    time: tuple[tuple[str, str | None], ...] = ()
    advice: str = ""

    def marked(self, names: Sequence[str]) -> bool:
        """Tell whether a file has a column that only this format has.

        Args:
            names: Names of its columns.
        """
        return any(labels_of(mark, names) for mark in self.marks)
