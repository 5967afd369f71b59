"""The columns that are read: those that the user names, then those of the format."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from cdia_pin.errors import LogError
from cdia_pin.logs.columns import ColumnNames, signal_of_all, sort_names
from cdia_pin.logs.formats.log_format import LogFormat, Recorded
from cdia_pin.logs.formats.patterns import TIME, required_labels
from cdia_pin.phrases import some

TORQUES = {"effort": "current", "current": "effort"}  # a file has one of them, or the user chooses


@dataclass(frozen=True)
class ColumnChoice:
    """Columns of each signal, and what they are.

    Attributes:
        format: Format of the file.
        columns: The columns by signal and joint label.
        recorded: What is known of a signal; signals of the project's own dialect are not in it.
    """

    format: LogFormat
    columns: ColumnNames
    recorded: Mapping[str, Recorded]

    def facts(self, signal: str) -> Recorded:
        """Return what is known of a signal.

        Args:
            signal: One of ``ALIASES``.
        """
        return self.recorded.get(signal, Recorded(signal, ()))


def choose_columns(names: Sequence[str], format_: LogFormat, own: Mapping[str, str]) -> ColumnChoice:
    """Choose the columns of each signal.

    Args:
        names: Names of the columns of the file.
        format_: Its format.
        own: {signal: pattern} as the user gives it.

    Returns:
        The columns; those that the user names come before those of the format.

    Raises:
        LogError: If a pattern of the user matches no column.
    """
    plain = _of_format(names, format_)
    signals, recorded = dict(plain.columns.signals), dict(plain.recorded)
    for signal, pattern in own.items():
        if signal == TIME:
            continue
        signals[signal] = required_labels(signal, pattern, names)
        first = next(iter(signals[signal].values()))
        known = (r for r in format_.recorded if r.signal == signal and first in r.columns(names).values())
        recorded[signal] = next(known, Recorded(signal, (pattern,)))
        if signal in TORQUES and TORQUES[signal] not in own:
            signals.pop(TORQUES[signal], None)
    used = {name for labels in signals.values() for name in labels.values()}
    time = _own_time(own[TIME], names) if TIME in own else plain.columns.time
    other = tuple(n for n in names if n not in used and n not in time)
    repeated = tuple(n for n in plain.columns.repeated if n not in used)
    return ColumnChoice(format_, ColumnNames(time, signals, repeated, other), recorded)


def for_one_joint(choice: ColumnChoice, joint: str) -> ColumnChoice:
    """Take columns that name a signal and no joint as those of the only joint, where a signal has no others.

    Args:
        choice: The columns of a plain table.
        joint: The only joint of the arm.
    """
    columns = choice.columns
    signals, other = dict(columns.signals), []
    for name in columns.other:
        signal = signal_of_all(name)
        if signal is None or signal in signals:
            other.append(name)
        else:
            signals[signal] = {joint: name}
    named = ColumnNames(columns.time, signals, columns.repeated, tuple(other))
    return replace(choice, columns=named)


def names_no_joint(choice: ColumnChoice, joint: str) -> bool:
    """Tell whether a column was taken as that of the only joint without naming it.

    Args:
        choice: The columns, see `for_one_joint`.
        joint: The only joint of the arm.
    """
    return any(signal_of_all(labels.get(joint, "")) for labels in choice.columns.signals.values())


def _of_format(names: Sequence[str], format_: LogFormat) -> ColumnChoice:
    """Choose the columns that a format names, or those of the project's own dialect."""
    if not format_.recorded:
        return ColumnChoice(format_, sort_names(names), {})
    signals: dict[str, dict[str, str]] = {}
    recorded = {}
    for quantity in format_.recorded:
        if quantity.signal in signals or quantity.only_on_request:
            continue
        if found := quantity.columns(names):
            signals[quantity.signal], recorded[quantity.signal] = found, quantity
    time = {name: unit for name, unit in format_.time if name in names} or sort_names(names).time
    return ColumnChoice(format_, ColumnNames(time, signals, (), ()), recorded)


def _own_time(name: str, names: Sequence[str]) -> dict[str, str | None]:
    if name not in names:
        raise LogError(f"columns: time={name} is no column; the log has {some(list(names))}")
    return {name: sort_names([name]).time.get(name)}
