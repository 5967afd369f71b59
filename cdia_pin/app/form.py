"""What is typed into the form of the first step, as a request and back."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from cdia_pin.app.inputs import Request
from cdia_pin.errors import LogError

UNITS = {
    "angle": "rad",
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
        joints: By joint: ``label``, its name in the log; ``gain``, ``reduction`` as typed; what is flipped.
        others: Conversions that have no place in the form.
        uploads: What the files at some paths were called before they were uploaded.
        model: Path of a model saved before.
    """

    robot: str = ""
    log: str = ""
    units: dict[str, str] = field(default_factory=lambda: dict(UNITS))
    joints: dict[str, dict[str, Cell]] = field(default_factory=dict)
    others: dict[str, object] = field(default_factory=dict)
    uploads: dict[str, str] = field(default_factory=dict)
    model: Path | None = None

    @property
    def plain(self) -> bool:
        """Whether nothing is said about names, units and gains."""
        return self.units == UNITS and not any(any(row.values()) for row in self.joints.values())

    def take(self, asked: Request) -> None:
        """Fill the form with a request."""
        given = dict(asked.convert)
        self.robot, self.log, self.model = asked.robot, str(asked.log), asked.model
        self.units = {key: given.pop(key, usual) or usual for key, usual in UNITS.items()}
        columns: dict[str, dict[str, Cell]] = {
            "label": {joint: name for name, joint in asked.joint_map.items()},
            "gain": dict(asked.gains),
            "reduction": dict(given.pop("reduction", {})),
            **{flip: dict.fromkeys(given.pop(flip, ()), True) for flip in FLIPS},
        }
        self.joints = {}
        for key, column in columns.items():
            for joint, value in column.items():
                self.note(joint, key, value)
        self.others = given

    def note(self, joint: str, key: str, value: Cell) -> None:
        """Take note of a cell of the table of joints."""
        self.joints.setdefault(joint, {})[key] = value

    def request(self) -> Request:
        """Return what is asked for.

        Raises:
            LogError: If a number is none.
        """
        convert: dict[str, object] = {k: v for k, v in self.units.items() if v != UNITS[k]} | self.others
        convert |= {flip: tuple(self._column(flip)) for flip in FLIPS if self._column(flip)}
        if ratios := self._numbers("reduction", "gear ratio"):
            convert["reduction"] = ratios
        return Request(
            self.robot.strip(),
            Path(self.log.strip()).expanduser(),
            model=self.model,
            joint_map={str(name).strip(): joint for joint, name in self._column("label").items()},
            gains=self._numbers("gain", "drive gain"),
            convert=convert,
            name=self.uploads.get(self.log.strip(), ""),
        )

    def _column(self, key: str) -> dict[str, Cell]:
        return {joint: row[key] for joint, row in self.joints.items() if row.get(key)}

    def _numbers(self, key: str, what: str) -> dict[str, float]:
        out = {}
        for joint, text in self._column(key).items():
            try:
                out[joint] = float(text)
            except ValueError:
                raise LogError(f"the {what} of {joint} must be a number, given '{text}'") from None
        return out
