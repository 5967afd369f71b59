"""Names of columns: the signal and the joint that each column holds.

The dialect is ``<signal>.<joint>``; one table lists the other names of each signal. The separator may be ``.``,
``/``, ``_`` or a space. ``q[3]``, ``q3`` and the joint first (``elbow_joint/position``) are accepted too, and so is a
word after the signal that says that it was measured (``tau_measured_3``).
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

ALIASES: dict[str, tuple[str, ...]] = {
    "position": ("position", "positions", "pos", "q", "joint_position", "joint_positions", "actual_q"),
    "velocity": (
        "velocity",
        "velocities",
        "vel",
        "v",
        "dq",
        "qd",
        "qdot",
        "q_dot",
        "joint_velocity",
        "joint_velocities",
        "actual_qd",
    ),
    "effort": (
        "effort",
        "efforts",
        "eff",
        "tau",
        "torque",
        "torques",
        "joint_effort",
        "joint_efforts",
        "joint_torque",
        "joint_torques",
    ),
    "current": (
        "current",
        "currents",
        "motor_current",
        "motor_currents",
        "joint_current",
        "joint_currents",
        "actual_current",
    ),
    "temperature": (
        "temperature",
        "temperatures",
        "temp",
        "joint_temperature",
        "joint_temperatures",
        "motor_temperature",
    ),
}
"""Names of each signal; the first one is that of the dialect."""

_TIME = re.compile(
    r"^(?:time|t|timestamp|stamp|time_?stamp)(?:[._/ ]?[\[(]?(s|sec|secs|seconds|ms|us|µs|μs|ns)[\])]?)?$",
    re.IGNORECASE,
)
_TIME_UNITS = {"sec": "s", "secs": "s", "seconds": "s", "µs": "us", "μs": "us"}

_MEASURED = r"(?:_(?:measured|meas|actual))?"  # beside what was commanded, which is another label

_SIGNAL = {alias: signal for signal, aliases in ALIASES.items() for alias in aliases}
_LONGEST_FIRST = "|".join(sorted((re.escape(a) for a in _SIGNAL), key=len, reverse=True))
_WORDS = "|".join(sorted((a for a in _SIGNAL if len(a) > 3), key=len, reverse=True))
_SIGNAL_FIRST = re.compile(rf"^({_LONGEST_FIRST}){_MEASURED}(?:[._/ ](.+)|\[(.+)\]|(\d+))$", re.IGNORECASE)
_ALL_JOINTS = re.compile(rf"^({_LONGEST_FIRST}){_MEASURED}$", re.IGNORECASE)
_JOINT_FIRST = re.compile(rf"^(.+)(?:[./ ]({_LONGEST_FIRST})|_({_WORDS})){_MEASURED}$", re.IGNORECASE)


@dataclass(frozen=True)
class ColumnNames:
    """Column names of a table, sorted by what the columns hold.

    Attributes:
        time: Columns that hold times, with their unit if the name states it.
        signals: For each signal, the column of each joint label of the log.
        repeated: Columns whose signal and joint an earlier column holds.
        other: All other columns.
    """

    time: dict[str, str | None]
    signals: dict[str, dict[str, str]]
    repeated: tuple[str, ...]
    other: tuple[str, ...]

    @property
    def time_column(self) -> str | None:
        """The column of times: ``time``, or else the first one; None without one."""
        return "time" if "time" in self.time else next(iter(self.time), None)

    def labels(self, signal: str) -> dict[str, str]:
        """Find the columns of a signal.

        Args:
            signal: one of ``ALIASES``.

        Returns:
            The column of each joint label; empty if the log lacks the signal.
        """
        return self.signals.get(signal, {})


def sort_names(names: Iterable[str]) -> ColumnNames:
    """Sort column names into times, signals of joints and the rest.

    Args:
        names: Names of the columns, in the order of the file.

    Returns:
        The sorted names.
    """
    time: dict[str, str | None] = {}
    signals: dict[str, dict[str, str]] = {}
    repeated, other = [], []
    for name in names:
        if match := _TIME.match(name.strip()):
            unit = match.group(1)
            time[name] = None if unit is None else _TIME_UNITS.get(unit.lower(), unit.lower())
        elif found := signal_of(name):
            signal, label = found
            if label in signals.setdefault(signal, {}):
                repeated.append(name)
            else:
                signals[signal][label] = name
        else:
            other.append(name)
    return ColumnNames(time, signals, tuple(repeated), tuple(other))


def signal_of_all(name: str) -> str | None:
    """Find the signal in a name that stands for all joints, such as ``tau_measured`` of an array (N, n).

    Args:
        name: The name.

    Returns:
        First name of ``ALIASES``; None if it is no signal.
    """
    match = _ALL_JOINTS.match(name.strip())
    return _SIGNAL[match.group(1).lower()] if match else None


def signal_of(name: str) -> tuple[str, str] | None:
    """Find the signal and the joint label in a column name.

    Args:
        name: Name of a column, such as ``effort.elbow_joint`` or ``q_3``.

    Returns:
        Signal (first name of ``ALIASES``) and joint label; None if the name is not of this form.
    """
    plain = name.strip().lstrip("/")
    if match := _SIGNAL_FIRST.match(plain):
        label = match.group(2) or match.group(3) or match.group(4)
        return _SIGNAL[match.group(1).lower()], label.strip()
    if match := _JOINT_FIRST.match(plain):
        return _SIGNAL[(match.group(2) or match.group(3)).lower()], match.group(1).strip()
    return None
