"""Guesses of what columns of unknown names hold, by their size, their smoothness and words in their names."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.angle_size import beyond_reach
from cdia_pin.logs.formats.groups import JointColumns, grouped
from cdia_pin.logs.formats.patterns import TIME
from cdia_pin.logs.timestamps import in_seconds

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

RATE_OF = 0.7  # [1], correlation with the derivative of another signal above which it is its velocity
COPY_OF = 0.995  # [1], correlation with the positions above which a signal is their command
SMALL = 0.05  # [1], largest torque over the limit of its joint below which it is rather a current
# Noise moves the size by less; the nearest other units, turns of the motor aside, are revolutions: per minute for
# degrees a sixth, per second for radians as well.
SAME_UNIT = 2.0  # factor within which a velocity has the size of its positions' derivative [1]
WARM = (10.0, 100.0)  # [°C] of motors
LEAST = 3  # [samples], of which something can be said
SAMPLES = 20_000  # [samples] that are looked at
# Words in names, which decide where sizes do not.
WORDS = {
    "temperature": r"temp|°c|celsius",
    "current": r"curr|cur(?![a-z])|amp|iq\b|\bi[_#*]",
    "effort": r"torq|trq|tau|moment|eff|\bnm\b|load",
    "velocity": r"vel|speed|spd|omega|rate|dq|qd|\bw[_#*]",
    "position": r"pos|ang|enc|deg|rad|joint|\bq[_#*]",
}
# Units in names of torques and currents that are not N·m and A, as `--convert torque=` has them.
UNITS = {
    "mA": re.compile(r"(?<![A-Za-z])mA(?![A-Za-z])|(?i:milli ?amp)"),
    "Nmm": re.compile(r"(?<![A-Za-z])(?:N[·.* ]?mm|mN[·.* ]?m)(?![A-Za-z])"),
}
ANGLES = {
    "deg": re.compile(r"(?<![A-Za-z])deg(?:rees?)?(?![A-Za-z])|°", re.IGNORECASE),
    "rad": re.compile(r"(?<![A-Za-z])rad(?:ians?)?(?![A-Za-z])", re.IGNORECASE),
}  # units in names of positions
UNWANTED = re.compile(r"target|cmd|command|desired|ref|goal|setp|_d\b", re.IGNORECASE)


@dataclass(frozen=True)
class ColumnGuess:
    """What some columns may hold.

    Attributes:
        pattern: Their names, ``#`` or ``*`` in the place of the joint; the name itself of a single column.
        signal: Signal that it may be; empty if nothing can be said.
        lowest: Smallest value, as logged.
        highest: Largest value, as logged.
        said: What speaks for it, in a few words.
        labels: Joint labels in the order of the file; empty for a single column.
    """

    pattern: str
    signal: str
    lowest: float
    highest: float
    said: str
    labels: tuple[str, ...] = ()

    @property
    def said_short(self) -> str:
        """The signal and what speaks for it, in a few words."""
        return f"{self.signal}? ({self.said})" if self.signal else self.said

    def __str__(self) -> str:
        return f"{self.pattern} {self.lowest:.3g} to {self.highest:.3g} {self.said_short}".rstrip()


def guess_columns(
    columns: Mapping[str, NDArray[Any]], robot: RobotModel, known: Mapping[str, str] | None = None
) -> list[ColumnGuess]:
    """Guess what the columns of a table hold.

    Args:
        columns: Numbers by name of the column, each of shape (N,).
        robot: The arm, for the number of joints and their limits.
        known: Signal, or ``time``, of each column that needs no guess; positions and velocities judge the others.

    Returns:
        A guess for each other group of columns with one for each joint, and for the column of times.
    """
    known = known or {}
    if len(next(iter(columns.values()), ())) < LEAST:
        return []
    several = (g.labels.values() for g in grouped(list(columns), robot.n) if len(g.labels) > 1)
    times = (
        [] if TIME in known.values() else list(_times(columns, {name for names in several for name in names}))
    )
    clocks = {*(t.pattern for t in times), *(name for name, signal in known.items() if signal == TIME)}
    groups = grouped([name for name in columns if name not in clocks], robot.n)
    values = {g.pattern: _values(columns, g) for g in groups}
    groups = [g for g in groups if np.isfinite(values[g.pattern]).any(axis=0).all()]
    words = {g.pattern: _word(g.pattern) for g in groups}
    named = {g.pattern: known.get(next(iter(g.labels.values())), "") for g in groups}
    moving = [g for g in groups if named[g.pattern] or not UNWANTED.search(g.pattern)]
    position, velocity = _moving(moving, values, words, named)
    guesses = list(times)
    clock = next((columns[name][:SAMPLES] for name in clocks if name in columns), np.zeros(0))
    seconds = in_seconds(clock, None, "")[0] if len(clock) and (np.diff(clock) > 0).all() else None
    taken = set(known.values())
    for group in groups:
        if named[group.pattern]:
            continue
        x = values[group.pattern]
        if group is position:
            signal, said = "position", _unit_of_angle(group.pattern, x, seconds, robot)
        elif group is velocity:
            signal, said = "velocity", "follows the change of the positions"
            if position and seconds is not None and not _same_unit(values[position.pattern], x, seconds):
                signal, said = "", "velocity in another unit?"
        elif position and not words[group.pattern] and _alike(x, values[position.pattern]) > COPY_OF:
            signal, said = "", "follows the positions: commanded?"
        else:
            signal, said = _torque_or_so(x, words[group.pattern], group.pattern, robot)
        if signal in taken:
            signal, said = "", f"another {signal}?"
        taken.add(signal)
        guesses.append(
            ColumnGuess(
                group.pattern, signal, float(np.nanmin(x)), float(np.nanmax(x)), said, tuple(group.labels)
            )
        )
    return guesses


def torques_among(names: Sequence[str], count: int) -> list[str]:
    """Return the patterns of columns that may be measured torques or currents by their names.

    Args:
        names: Names of columns.
        count: Number of joints.
    """
    patterns = (group.pattern for group in grouped(names, count))
    return [p for p in patterns if _word(p) in {"effort", "current"} and not UNWANTED.search(p)]


def reading_of(guesses: Sequence[ColumnGuess], robot: RobotModel) -> dict[str, str]:
    """Return the options by which a log is read as guessed.

    Args:
        guesses: The guesses; those without a signal are left out.
        robot: The arm, by whose joints columns without numbers are named in the order of the file.

    Returns:
        Values of ``columns``, ``convert`` and ``joint_map``, those that are needed.
    """
    known = [g for g in guesses if g.signal]
    out = {"columns": ",".join(f"{g.signal}={g.pattern}" for g in known)} if known else {}
    units = ["angle=deg"] if any(g.signal == "position" and g.said == "deg" for g in known) else []
    units += _unit_of_torque(known)
    if units:
        out["convert"] = ",".join(units)
    labels = next((g.labels for g in known if g.labels and not g.labels[0].isdigit()), ())
    if labels and not set(robot.joints) <= set(labels):
        out["joint_map"] = ",".join(f"{a}={b}" for a, b in zip(labels, robot.joints, strict=True))
    return out


def options_of(guesses: Sequence[ColumnGuess], robot: RobotModel) -> str:
    """Return what to type so that a log is read as guessed.

    Args:
        guesses: The guesses.
        robot: The arm.
    """
    reading = reading_of(guesses, robot)
    said = [f"--{name.replace('_', '-')} {shlex.quote(value)}" for name, value in reading.items()]
    signals = {g.signal for g in guesses}
    currents = ("current" in signals and "effort" not in signals) or "torque=mA" in reading.get("convert", "")
    return " ".join([*said, *(["--gains gains.json"] if currents else [])])


def said_of(guesses: Sequence[ColumnGuess], robot: RobotModel) -> str:
    """Return guesses and what to type in one sentence; empty if nothing was found.

    Args:
        guesses: The guesses.
        robot: The arm.
    """
    if not guesses:
        return ""
    looks = "; ".join(map(str, guesses))
    options = options_of(guesses, robot)
    return f"the columns look like: {looks}" + (f"; if that is right, type {options}" if options else "")


def _unit_of_torque(known: Sequence[ColumnGuess]) -> list[str]:
    """Return the conversion of the columns that will be read as torque, if their names state a unit that needs one."""
    signals = {g.signal: g.pattern for g in known}
    name = signals.get("effort", signals.get("current", ""))
    return [f"torque={unit}" for unit, said in UNITS.items() if said.search(name)]


def _unit_of_angle(pattern: str, x: Array, seconds: Array | None, robot: RobotModel) -> str:
    """Return the unit of angles: that in their name, or degrees if the joints do not reach so far in rad."""
    stated = next((unit for unit, said in ANGLES.items() if said.search(pattern)), "")
    if stated:
        return stated
    whole = np.isfinite(x).all(axis=1)
    far = whole.any() and beyond_reach(x[whole], None if seconds is None else seconds[whole], robot).any()
    return "deg" if far else "rad"


def _values(columns: Mapping[str, NDArray[Any]], group: JointColumns) -> Array:
    x = np.column_stack([np.asarray(columns[name], dtype=np.float64) for name in group.labels.values()])
    return x[:SAMPLES]


def _moving(
    groups: Sequence[JointColumns], values: dict[str, Array], words: dict[str, str], named: dict[str, str]
) -> tuple[JointColumns | None, JointColumns | None]:
    """Find the positions, and the velocities that are their derivative; without those, the smoothest signal.

    Positions and velocities that the user or their names tell are those, and no others.
    """

    def possible(signal: str) -> list[JointColumns]:
        told = [g for g in groups if named[g.pattern] == signal]
        return told or [g for g in groups if not named[g.pattern] and words[g.pattern] in {"", signal}]

    pairs = [
        (_alike(np.gradient(values[a.pattern], axis=0), values[b.pattern]), a, b)
        for a in possible("position")
        for b in possible("velocity")
        if a is not b
    ]
    best = max(pairs, key=lambda pair: pair[0], default=None)
    if best is not None and best[0] > RATE_OF:
        return best[1], best[2]
    positions = [g for g in possible("position") if words[g.pattern] == "position" or named[g.pattern]] or [
        g for g in possible("position") if _roughness(values[g.pattern]) < np.inf
    ]
    velocity = next((g for g in possible("velocity") if words[g.pattern] == "velocity"), None)
    return min(positions, key=lambda g: _roughness(values[g.pattern]), default=None), velocity


def _alike(x: Array, y: Array) -> float:
    """Return the median over the joints of the correlation of two signals [1]."""
    x, y = x - np.nanmean(x, axis=0), y - np.nanmean(y, axis=0)
    size = np.sqrt(np.nansum(x * x, axis=0) * np.nansum(y * y, axis=0))
    moving = size > 0
    return float(np.median(np.nansum(x * y, axis=0)[moving] / size[moving])) if moving.any() else 0.0


def _same_unit(position: Array, velocity: Array, seconds: Array) -> bool:
    """Tell whether velocities have the size of the derivative of the positions."""
    rate = np.gradient(position, seconds, axis=0)
    moving = np.nanstd(rate, axis=0) > 0
    if not moving.any():
        return True
    slope = float(np.median(np.nanstd(velocity, axis=0)[moving] / np.nanstd(rate, axis=0)[moving]))
    return 1 / SAME_UNIT < slope < SAME_UNIT


def _roughness(x: Array) -> float:
    """Return the change from sample to sample over the spread [1]; infinite if nothing changes."""
    spread = np.nanstd(x, axis=0)
    moving = spread > 0
    return (
        float(np.median(np.nanstd(np.diff(x, axis=0), axis=0)[moving] / spread[moving]))
        if moving.any()
        else np.inf
    )


def _torque_or_so(x: Array, word: str, pattern: str, robot: RobotModel) -> tuple[str, str]:
    """Name a signal that is no motion: by a word in its name, or by its size."""
    if UNWANTED.search(pattern):
        return "", "commanded?"
    if word in {"effort", "current", "temperature"}:
        return word, "by its name"
    if word:
        return "", f"{word}? by its name"
    if WARM[0] < np.nanmin(x) and np.nanmax(x) < WARM[1]:
        return "temperature", f"between {WARM[0]:g} and {WARM[1]:g}"
    limits = np.where(robot.limits.effort > 0, robot.limits.effort, np.inf)
    share = float(np.max(np.nanmax(np.abs(x), axis=0) / limits))
    if share == 0:  # nothing is there, or the URDF states no limits
        return "", "nothing that its size tells"
    size = f"up to {share:.0%} of the torque limits"
    return ("current", size) if share < SMALL else ("effort", size)


def _times(columns: Mapping[str, NDArray[Any]], used: set[str]) -> Iterator[ColumnGuess]:
    """Yield the first column that increases throughout."""
    for name, x in columns.items():
        if name not in used and len(x) > 1 and (np.diff(x) > 0).all():
            yield ColumnGuess(name, TIME, float(x[0]), float(x[-1]), "increases throughout")
            return


def _word(pattern: str) -> str:
    return next((signal for signal, words in WORDS.items() if re.search(words, pattern, re.IGNORECASE)), "")
