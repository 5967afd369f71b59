"""The error for columns of unknown names, which carries a guess of what they hold."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cdia_pin.errors import LogError
from cdia_pin.logs.columns import ALIASES
from cdia_pin.logs.formats import CSV
from cdia_pin.logs.formats.guess import ColumnGuess, guess_columns, said_of
from cdia_pin.logs.formats.patterns import TIME
from cdia_pin.logs.signal_picker import SignalPicker

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel


class MissingColumnsError(LogError):
    """Positions or torques of a log have no columns of a known name.

    Attributes:
        missing: What is missing, without the guesses.
        guesses: What its columns may hold.
    """

    def __init__(self, missing: str, guessed: str, guesses: list[ColumnGuess]):
        super().__init__(f"{missing}; {guessed}")
        self.missing, self.guesses = missing, guesses


def require_columns(pick: SignalPicker, robot: RobotModel, *, times: bool = True) -> None:
    """Require columns of positions, torques or currents, and times.

    Args:
        pick: The columns of a log.
        robot: Its arm.
        times: Whether the log must have times.

    Raises:
        MissingColumnsError: If columns of a plain table lack one of them; the message shows all columns with a guess of
            each, and what to type if it is right.
        LogError: If a format lacks one of its own; the message says what to record.
    """
    labels = pick.columns.labels
    missing = [] if labels("position") else ["position"]
    missing += [] if labels("effort") or labels("current") else ["effort"]
    if not missing and times and pick.columns.time_column is None:
        missing = ["time"]
    if not missing:
        return
    said = pick.missing(missing[0])
    if pick.choice.format != CSV:
        raise LogError(f"{said}; found {pick.found}")
    known = {name: signal for signal in ALIASES for name in labels(signal).values()}
    if pick.columns.time_column is not None:
        known[pick.columns.time_column] = TIME
    asked = {*known, *pick.columns.other}
    columns = {name: x for name, x in pick.table.columns.items() if name in asked}
    guesses = guess_columns(columns, robot, known)
    raise MissingColumnsError(said, said_of(guesses, robot) or f"found {pick.found}", guesses)
