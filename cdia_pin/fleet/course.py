"""The course of a parameter: its value in each log of a robot, in the order in which they were recorded."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.fleet.fleet_effects import Role
from cdia_pin.fleet.store import FleetStore

if TYPE_CHECKING:
    import pyarrow as pa

Array = NDArray[np.float64]

# Half width of a 95 % interval over the standard deviation, as `FleetFitSettings.blocks` has it [1].
HALF_WIDTHS = 2.2
# Speed of a joint over its median in all logs [1], up or down, beyond which a log is another motion: no friction law
# of two or three parameters holds over a larger range of speeds.
OTHER_SPEED = 2.0
# Interval over the median one of all logs [1], beyond which a log says next to nothing about a parameter.
TOO_WIDE = 10.0
SHOWN_DIGITS = 8  # of a log's hash [1] at least, behind a name that several logs have
NEEDED = ("robot", "log", "sha256", "setup", "version", "added", "recorded", "failure", "effect", "joints", "parameter",
          "unit", "role", "model_value", "value", "ci95_low", "ci95_high", "ci95_statistical_low",
          "ci95_statistical_high", "not_shown", "temperature", "load", "speed")  # fmt: skip


@dataclass(frozen=True, repr=False)
class Course:
    """A parameter of a robot over its logs; arrays have shape (N,), with NaN where nothing is known.

    Attributes:
        robot: Name of the robot.
        effect: Name of the effect.
        joints: Its joints; empty for one of the whole arm.
        parameter: Name of the parameter.
        unit: Its unit.
        role: What the effect is in the fit.
        model_value: The parameter in the model.
        logs: Names of the logs, each with a part of its hash where several have the same.
        recorded: When each was recorded; None where nothing says it.
        value: The parameter.
        half_width: Half width of its 95 % interval, statistical and systematic together.
        deviation: Standard deviation of the value, from the scatter of its log alone.
        temperature: Temperature of the joint [°C].
        load: RMS torque of the joint in the model, with what changes with the job [N·m or N].
        not_comparable: Why a log says nothing here; empty where it does.
    """

    robot: str
    effect: str
    joints: tuple[str, ...]
    parameter: str
    unit: str
    role: Role
    model_value: float
    logs: tuple[str, ...]
    recorded: tuple[datetime | None, ...]
    value: Array
    half_width: Array
    deviation: Array
    temperature: Array
    load: Array
    not_comparable: tuple[str, ...]

    def __repr__(self) -> str:
        return f"Course({self.robot}, {self.label}; {int(self.use.sum())} of {len(self.logs)} logs)"

    @property
    def label(self) -> str:
        """Effect, joints and parameter."""
        return (
            f"{self.effect}@{'+'.join(self.joints)}.{self.parameter}"
            if self.joints
            else f"{self.effect}.{self.parameter}"
        )

    @cached_property
    def use(self) -> NDArray[np.bool_]:
        """True for the logs that can be compared, shape (N,)."""
        return np.array([not why for why in self.not_comparable], bool)


@dataclass(frozen=True)
class RobotCourses:
    """All courses of a robot.

    Attributes:
        robot: Name of the robot.
        courses: The courses.
        logs: Number of its logs.
        failed: Reason by name of the log that gave nothing.
        outdated: Number of logs that were added with another setup of the robot, or by another version, only.
        dated: Whether all logs say when they were recorded; else they are in the order of their names, and those of
            one name in the order in which they were added.
        days: Time from the first log to the last one [days]; NaN if not dated.
    """

    robot: str
    courses: tuple[Course, ...]
    logs: int
    failed: dict[str, str]
    outdated: int
    dated: bool
    days: float


def courses_of(store: FleetStore) -> Iterator[RobotCourses]:
    """Yield the courses of each robot of a store.

    Args:
        store: The store.
    """
    import pyarrow.compute as pc

    table = store.table(NEEDED)
    for robot in sorted(set(table["robot"].to_pylist())):
        yield _robot(robot, table.filter(pc.equal(table["robot"], robot)))


def _robot(name: str, table: pa.Table) -> RobotCourses:
    cells = {key: table[key].to_pylist() for key in table.column_names}
    # What another version fits may differ as what another model leaves does: neither passes for wear.
    setups = list(zip(cells["setup"], cells["version"], strict=True))
    _, setup = max((str(at or ""), k) for k, at in enumerate(cells["added"]))
    now = [k for k, s in enumerate(setups) if s == setups[setup]]
    row_of = {cells["sha256"][k]: k for k in now}
    called = _names({log: str(cells["log"][k]) for log, k in row_of.items()})
    failed = {called[log]: cells["failure"][k] for log, k in row_of.items() if cells["failure"][k]}
    when = {log: cells["recorded"][k] for log, k in row_of.items() if not cells["failure"][k]}
    dated = bool(when) and all(at is not None for at in when.values())

    def place(log: str) -> tuple[object, ...]:
        k = row_of[log]
        named = (cells["log"][k], str(cells["added"][k]), log)
        return (when[log], *named) if dated else named

    order = sorted(when, key=place)
    times = [when[log] for log in order]
    days = (times[-1] - times[0]).total_seconds() / 86400 if dated else float("nan")
    groups: dict[tuple[str, str, str], dict[str, int]] = {}
    for k in now:
        if cells["effect"][k]:
            key = (cells["effect"][k], cells["joints"][k], cells["parameter"][k])
            groups.setdefault(key, {})[cells["sha256"][k]] = k
    courses = tuple(
        _course(name, {called[log]: rows[log] for log in order if log in rows}, cells)
        for rows in groups.values()
    )
    outdated = len(set(cells["sha256"]) - row_of.keys())
    return RobotCourses(name, courses, len(row_of), failed, outdated, dated, days)


def _names(names: dict[str, str]) -> dict[str, str]:
    """Return what each log is called, by its hash: its name, with a part of the hash where others have the same."""
    times = Counter(names.values())
    digits = SHOWN_DIGITS
    while len({log[:digits] for log in names}) < len(names):
        digits += 1
    return {log: n if times[n] == 1 else f"{n} ({log[:digits]})" for log, n in names.items()}


def _course(robot: str, row_of: dict[str, int], cells: dict[str, list[object]]) -> Course:
    rows = list(row_of.values())

    def numbers(key: str) -> Array:
        return np.array([cells[key][k] for k in rows], float)  # None becomes NaN

    def text(key: str) -> str:
        return str(cells[key][rows[-1]] or "")

    value, speed = numbers("value"), numbers("speed")
    statistical = (numbers("ci95_statistical_high") - numbers("ci95_statistical_low")) / 2
    shown = np.isfinite(value)
    with np.errstate(all="ignore"):
        usual = np.median(speed[shown]) if shown.any() else np.nan
        wide = np.median(statistical[shown]) if shown.any() else np.nan
    why = []
    for k, row in enumerate(rows):
        if not shown[k]:
            why.append(str(cells["not_shown"][row] or "not fitted"))
        elif np.isfinite(usual) and not usual / OTHER_SPEED <= speed[k] <= usual * OTHER_SPEED:
            why.append("the joint moves at other speeds")
        elif statistical[k] > TOO_WIDE * wide:
            why.append("the motion hardly shows it")
        else:
            why.append("")
    return Course(
        robot,
        text("effect"),
        tuple(j for j in text("joints").split("+") if j),
        text("parameter"),
        text("unit"),
        Role(text("role")),
        float(numbers("model_value")[-1]),
        tuple(row_of),
        tuple(cells["recorded"][k] for k in rows),  # type: ignore[misc]
        value,
        (numbers("ci95_high") - numbers("ci95_low")) / 2,
        statistical / HALF_WIDTHS,
        numbers("temperature"),
        numbers("load"),
        tuple(why),
    )
