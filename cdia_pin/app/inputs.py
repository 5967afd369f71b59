"""The inputs of a session: a robot, a log and how it was read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from cdia_pin.dynamics import Dynamics, load_model
from cdia_pin.errors import LogError, RobotError
from cdia_pin.logs import Log, LogCheck, check_log, read_log
from cdia_pin.logs.conversion import Conversion
from cdia_pin.logs.formats import column_patterns
from cdia_pin.logs.gains import gains_by_joint
from cdia_pin.logs.joint_names import joint_map_of
from cdia_pin.progress import Progress
from cdia_pin.robot import RobotModel, load_robot

# Fields of a request that are options of `read_log`.
READING = ("gains", "joint_map", "convert", "format", "columns", "episode")
Gain = float | Mapping[str, Any]  # [N·m/A], or {"value": …, "tolerance": …}, as `read_gains` takes them


@dataclass(frozen=True)
class Request:
    """A robot, a log and how to read it; the fields are those of `load_robot`, `load_model` and `read_log`.

    Attributes:
        robot: Name of the catalogue, or path of a URDF.
        log: Path of the log.
        model: Path of a saved model; None for the URDF alone.
        joint_map: Name in the log → joint of the robot.
        convert: Units and signs that are not SI or not the URDF's.
        gains: Drive gains [N·m/A] by joint, where the log has motor currents.
        format: Name of the log's format; None to recognise it.
        columns: {signal: pattern} for columns of other names.
        episode: Episode of a LeRobot dataset, if it has several.
        name: Name of the log where its path says nothing, as of a file that was dropped on the page.
        robot_name: The same for the URDF.
    """

    robot: str
    log: Path
    model: Path | None = None
    joint_map: Mapping[str, str] = field(default_factory=dict)
    convert: Mapping[str, Any] = field(default_factory=dict)
    gains: Mapping[str, Gain] = field(default_factory=dict)
    format: str | None = None
    columns: Mapping[str, str] = field(default_factory=dict)
    episode: int | None = None
    name: str = ""
    robot_name: str = ""

    @classmethod
    def as_typed(
        cls,
        robot: str,
        log: Path,
        *,
        model: Path | None = None,
        gains: Path | None = None,
        joint_map: Sequence[str] | None = None,
        convert: Sequence[str] | None = None,
        format: str | None = None,
        columns: Sequence[str] | None = None,
        episode: int | None = None,
    ) -> Request:
        """Return what the options of a command ask for; each argument is the option of that name.

        Raises:
            LogError: If an option cannot be understood, or the file of gains cannot be read.
        """
        asked = cls(
            robot,
            log,
            model,
            joint_map=joint_map_of(joint_map),
            gains=gains_by_joint(gains) if gains else {},
            format=format,
            columns=column_patterns(columns, one_joint=True),  # read_log knows the arm
            episode=episode,
        )
        for option in convert or ():
            asked = asked.converted(option)
        return asked

    @property
    def reading(self) -> dict[str, Any]:
        """The options of `read_log` that are needed."""
        return {name: value for name in READING if (value := getattr(self, name)) not in (None, {})}

    def converted(self, option: str) -> Request:
        """Return the request with one conversion more.

        Args:
            option: As an advice of `check_log` names it, such as ``angle=deg`` or ``flip_effort=elbow_joint``.

        Raises:
            LogError: If it cannot be understood.
        """
        convert, usual = dict(self.convert), Conversion()
        for name, value in vars(Conversion.of([option])).items():
            if value != getattr(usual, name):
                flips = isinstance(value, tuple)
                convert[name] = tuple(dict.fromkeys((*convert.get(name, ()), *value))) if flips else value
        return replace(self, convert=convert)


@dataclass(frozen=True, eq=False)
class Inputs:
    """What was loaded.

    Attributes:
        request: What was asked for.
        model: The robot, with the terms of a saved model if there is one.
        log: The log.
        check: What `check_log` says of it.
    """

    request: Request
    model: Dynamics
    log: Log
    check: LogCheck

    @property
    def robot(self) -> RobotModel:
        """The arm."""
        return self.model.robot

    @classmethod
    def load(cls, asked: Request, tell: Progress, model: Dynamics) -> Inputs:
        """Read and check a log.

        Args:
            asked: What to read.
            tell: Reports progress.
            model: What `read_model` returned for the same request.

        Raises:
            CdiaError: If a file cannot be used; its message says what to do.
        """
        if asked.log == Path() or not asked.log.exists():
            raise LogError(f"there is no log {asked.log}")
        tell("reading the log", 0.2)
        log = read_log(asked.log, model.robot, **asked.reading)
        tell("checking the log", 0.6)
        return cls(asked, model, log, check_log(log, model.robot))


def read_model(asked: Request) -> Dynamics:
    """Return the robot of a request, with the terms of its saved model if there is one.

    Args:
        asked: What to read.

    Raises:
        CdiaError: If a file cannot be used.
    """
    if not asked.robot:
        raise RobotError("name a robot of the catalogue, or give the path of a URDF, or drop one on the page")
    robot = load_robot(asked.robot)
    return load_model(asked.model, robot) if asked.model else Dynamics(robot)
