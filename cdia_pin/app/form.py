"""The form of the first step, as a request and back."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cdia_pin.app.inputs import Gain, Request
from cdia_pin.errors import LogError

UNITS = {
    "angle": "",
    "length": "m",
    "torque": "Nm",
    "time": "",
}  # with what is meant where nothing is said
Cell = str | float | bool  # of the table of joints: typed, from a request, or checked

FLIPS = ("flip_position", "flip_effort")


@dataclass
class Form:
    """Texts and marks of the form.

    Attributes:
        robot: Name of the catalogue, or path of a URDF.
        log: Path of the log.
        units: Unit of each kind of signal.
        format: Name of the log's format; empty to recognise it.
        columns: {signal: pattern} for columns of other names; empty patterns are signals that the log lacks.
        episode: Episode of a LeRobot dataset, as typed.
        rate: Rows per second of a log without times [Hz], as typed.
        joints: By joint: ``label``, its name in the log; ``gain``, ``reduction`` as typed; what is flipped.
        others: Conversions that have no place in the form.
        dropped: Files that were dropped on the page, by the names that the fields show.
        model: Path of a model saved before.
    """

    robot: str = ""
    log: str = ""
    units: dict[str, str] = field(default_factory=lambda: dict(UNITS))
    format: str = ""
    columns: dict[str, str] = field(default_factory=dict)
    episode: str = ""
    rate: str = ""
    joints: dict[str, dict[str, Cell]] = field(default_factory=dict)
    others: dict[str, object] = field(default_factory=dict)
    dropped: dict[str, Path] = field(default_factory=dict)
    model: Path | None = None

    @property
    def plain(self) -> bool:
        """Whether format, names, units and gains are left as they are."""
        said = (self.format, self.episode, self.rate, *self.columns.values(), *self._cells())
        return self.units == UNITS and not any(said)

    def _cells(self) -> Iterator[Cell]:
        for row in self.joints.values():
            yield from row.values()

    def take(self, asked: Request) -> None:
        """Fill the form with a request.

        Args:
            asked: The request.
        """
        given = dict(asked.convert)
        self.robot, self.log, self.model = self._shown(asked.robot), self._shown(asked.log), asked.model
        self.units = {key: given.pop(key, usual) or usual for key, usual in UNITS.items()}
        self.format, self.columns = asked.format or "", dict(asked.columns)
        self.episode = "" if asked.episode is None else str(asked.episode)
        rate = given.pop("rate", None)
        self.rate = "" if rate is None else str(rate)
        columns: dict[str, dict[str, Cell]] = {
            "label": {joint: name for name, joint in asked.joint_map.items()},
            "gain": {joint: gain_text(gain) for joint, gain in asked.gains.items()},
            "reduction": dict(given.pop("reduction", {})),
            **{flip: dict.fromkeys(given.pop(flip, ()), True) for flip in FLIPS},
        }
        self.joints = {}
        for key, column in columns.items():
            self.fill(key, column)
        self.others = given

    def note(self, joint: str, key: str, value: Cell) -> None:
        """Set a cell of the table of joints.

        Args:
            joint: Row.
            key: Column: ``label``, ``gain``, ``reduction``, ``flip_position`` or ``flip_effort``.
            value: Text or mark.
        """
        self.joints.setdefault(joint, {})[key] = value

    def cell(self, joint: str, key: str) -> Cell | None:
        """Return a cell of the table of joints; None where nothing was noted.

        Args:
            joint: Row.
            key: Column, as of `note`.
        """
        return self.joints.get(joint, {}).get(key)

    def keep(self, joints: Sequence[str]) -> None:
        """Drop the rows of joints that a robot does not have.

        Args:
            joints: Joints of the robot.
        """
        self.joints = {joint: row for joint, row in self.joints.items() if joint in joints}

    def fill(self, key: str, column: Mapping[str, Cell]) -> None:
        """Set a column of the table of joints.

        Args:
            key: As of `note`.
            column: Cells by joint.
        """
        for joint, value in column.items():
            self.note(joint, key, value)

    def dropped_as(self, path: Path) -> str:
        """Return the name under which a field shows a file that was dropped.

        Args:
            path: The file.
        """
        self.dropped[path.name] = path
        return path.name

    def faults(self) -> dict[str, str]:
        """Return what is wrong with numbers as they are typed, by the mark of their field."""
        out = {}
        for key, (what, read) in NUMBERS.items():
            for joint, text in self._column(key).items():
                try:
                    read(str(text))
                except ValueError:
                    out[f"{key}-{joint}"] = f"the {what} of {joint} must be a number, given '{text}'"
        if self.episode.strip() and not self.episode.strip().isdecimal():
            out["episode"] = f"the episode must be a number from 0 on, given '{self.episode}'"
        try:
            float(self.rate.strip() or 0)
        except ValueError:
            out["rate"] = f"the rate must be a number [Hz], given '{self.rate}'"
        return out

    def request(self) -> Request:
        """Return the form as a request.

        Raises:
            LogError: If a number cannot be read.
        """
        for sentence in self.faults().values():
            raise LogError(sentence)
        convert: dict[str, object] = {k: v for k, v in self.units.items() if v != UNITS[k]} | self.others
        convert |= {flip: tuple(self._column(flip)) for flip in FLIPS if self._column(flip)}
        if ratios := self._numbers("reduction"):
            convert["reduction"] = ratios
        if self.rate.strip():
            convert["rate"] = float(self.rate)
        robot, log = self.robot.strip(), self.log.strip()
        return Request(
            str(self.dropped.get(robot, robot)),
            self.dropped.get(log, Path(log).expanduser()),
            model=self.model,
            joint_map={str(name).strip(): joint for joint, name in self._column("label").items()},
            gains=self._numbers("gain"),
            convert=convert,
            format=self.format or None,
            columns={signal: pattern for signal, pattern in self.columns.items() if pattern},
            episode=int(self.episode) if self.episode.strip() else None,
            name=log if log in self.dropped else "",
            robot_name=robot if robot in self.dropped else "",
        )

    def _shown(self, path: str | Path) -> str:
        """Return a path as its field shows it: by its name, if it was dropped on the page."""
        names = [name for name, at in self.dropped.items() if str(at) == str(path)]
        return names[0] if names else "" if path == Path() else str(path)

    def _column(self, key: str) -> dict[str, Cell]:
        return {joint: row[key] for joint, row in self.joints.items() if row.get(key)}

    def _numbers(self, key: str) -> dict[str, Any]:
        read = NUMBERS[key][1]
        return {joint: read(str(text)) for joint, text in self._column(key).items()}


def gain_text(gain: Gain) -> str:
    """Return a drive gain as its field shows it: ``14.9``, or ``14.9 ± 0.7`` with its tolerance.

    Args:
        gain: A number, or a mapping with ``value`` and ``tolerance``.
    """
    if not isinstance(gain, Mapping):
        return str(gain)
    tolerance = gain.get("tolerance")
    return str(gain.get("value", "")) + ("" if tolerance is None else f" ± {tolerance}")


def read_gain(text: str) -> Gain:
    """Return the drive gain that was typed.

    Args:
        text: As of `gain_text`.

    Raises:
        ValueError: If it is none.
    """
    value, sign, tolerance = text.partition("±")
    return {"value": float(value), "tolerance": float(tolerance)} if sign else float(value)


NUMBERS: dict[str, tuple[str, Callable[[str], Any]]] = {
    "gain": ("drive gain", read_gain),
    "reduction": ("gear ratio", float),
}  # columns that hold numbers, with what they are called and how they are read
