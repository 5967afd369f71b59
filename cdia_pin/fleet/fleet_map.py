"""The map of a fleet: which robot has which model, and which logs are its own."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date, datetime, time
from fnmatch import fnmatch
from functools import cached_property
from itertools import takewhile
from pathlib import Path
from typing import Any, Self

from cdia_pin.effects import EFFECTS
from cdia_pin.errors import CdiaError, unknown_name
from cdia_pin.fleet.fleet_settings import FleetFitSettings
from cdia_pin.input_files import read_text, resolved
from cdia_pin.phrases import one_line, shortened, some

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,79}")  # of a robot, which is also that of a folder
READING = ("joint_map", "convert", "format", "columns", "torque_side")  # options of reading logs
KEYS = ("robot", "model", "gains", "logs", "recorded", "job", "searched", "cutoff", *READING)

WILDCARDS = frozenset("*?[")


class FleetError(CdiaError):
    """A map of robots or a store cannot be used."""


@dataclass(frozen=True)
class FleetRobot:
    """One robot of a fleet.

    Attributes:
        name: Its name, such as a serial number.
        robot: Name of the catalogue, or path of its URDF.
        logs: Patterns of the paths of its logs.
        model: File of its model; the URDF alone if None.
        gains: File of its drive gains, where logs have currents.
        reading: Options of reading its logs, as (name, value).
        recorded: When logs were recorded that do not say it, as (pattern of the file's name, time).
        settings: What is fitted in its logs.
    """

    name: str
    robot: str
    logs: tuple[str, ...]
    model: Path | None = None
    gains: Path | None = None
    reading: tuple[tuple[str, str | tuple[str, ...]], ...] = ()
    recorded: tuple[tuple[str, datetime], ...] = ()
    settings: FleetFitSettings = field(default_factory=FleetFitSettings)

    def stated_time(self, log: Path) -> datetime | None:
        """Return when a log was recorded, as far as the map states it.

        Args:
            log: Its path.
        """
        return next((at for pattern, at in self.recorded if fnmatch(log.name, pattern)), None)

    def folders_of(self, log: Path) -> tuple[str, ...]:
        """Return the names of the folders in which the robot's logs differ, the outermost first.

        A folder that all patterns share says nothing of one log: a date in its name may be that of a backup.

        Args:
            log: Path of one of them.
        """
        shared = Path(os.path.commonpath([resolved(_fixed_folder(pattern)) for pattern in self.logs]))
        folder = resolved(log).parent
        return folder.relative_to(shared).parts if folder.is_relative_to(shared) else ()


@dataclass(frozen=True)
class FleetMap:
    """The robots of a fleet.

    Attributes:
        path: The file.
        robots: The robots, in its order.
    """

    path: Path
    robots: tuple[FleetRobot, ...]

    @classmethod
    def read(cls, path: str | Path) -> Self:
        """Read a map; paths in it are relative to its folder.

        Args:
            path: The TOML file: a table ``[robots.NAME]`` for each robot.

        Raises:
            FleetError: If it cannot be read, or a robot in it cannot be used.
        """
        path = Path(path)
        try:
            document = tomllib.loads(read_text(path))
        except OSError as error:
            raise FleetError(f"cannot read the map {path}: {error.strerror}") from None
        except ValueError as error:  # of TOML and of UTF-8
            raise FleetError(f"{path} is not a map of robots: {one_line(error)}") from None
        robots = document.get("robots")
        if not isinstance(robots, Mapping) or not robots:
            raise FleetError(f"{path}: expected a table [robots.NAME] for each robot, found none")
        if others := [key for key in document if key != "robots"]:
            raise FleetError(f"{path}: {unknown_name('table', others[0], ['robots'])}")
        return cls(path, tuple(_robot(path, name, given) for name, given in robots.items()))

    def robot_of(self, log: Path) -> FleetRobot:
        """Return the robot of a log.

        Args:
            log: Its path.

        Raises:
            FleetError: If it is of no robot, or of several.
        """
        owners = self._owners.get(resolved(log), [])
        if not owners:
            patterns = some([shortened(p, 60) for r in self.robots for p in r.logs], 3)
            raise FleetError(f"{log} is of no robot of {self.path}: its patterns of logs are {patterns}")
        if len(owners) > 1:
            raise FleetError(
                f"{log} is of several robots of {self.path}: {some([r.name for r in owners], 3)}"
            )
        return owners[0]

    @property
    def logs(self) -> tuple[Path, ...]:
        """The logs of all robots that are on the disk, sorted."""
        return tuple(sorted(self._owners))

    @cached_property
    def _owners(self) -> dict[Path, list[FleetRobot]]:
        """The robots of each log that is on the disk."""
        out: dict[Path, list[FleetRobot]] = {}
        for robot in self.robots:
            found = {resolved(p) for pattern in robot.logs for p in _found(pattern)}
            for log in found:
                out.setdefault(log, []).append(robot)
        return out


def _fixed_folder(pattern: str) -> Path:
    """Return the part of a pattern's folder before the first wildcard."""
    fixed = takewhile(lambda part: not WILDCARDS & set(part), Path(pattern).parent.parts)
    return Path(*fixed)


def _found(pattern: str) -> Iterator[Path]:
    """Yield the paths that a pattern with an absolute beginning finds."""
    root = Path(Path(pattern).anchor)
    try:
        yield from root.glob(str(Path(pattern).relative_to(root)))
    except (ValueError, NotImplementedError) as error:  # such as "a**b"
        raise FleetError(f"the pattern of logs {pattern} cannot be used: {one_line(error)}") from None


def _robot(path: Path, name: str, given: Any) -> FleetRobot:
    """Return a robot of a map; each error names the robot and what is valid."""
    where = f"{path}: robot '{name}'"
    if not NAME.fullmatch(name):
        raise FleetError(f"{where}: a name has letters, digits, '-', '_' and '.', at most 80")
    if not isinstance(given, Mapping):
        raise FleetError(f"{where}: expected a table [robots.{name}]")
    for key in given:
        if key not in KEYS:
            raise FleetError(f"{where}: {unknown_name('key', key, KEYS)}")
    folder = resolved(path).parent
    logs = _texts(given, "logs", where)
    if not logs:
        raise FleetError(f'{where}: states no logs; write logs = ["{name}/*.csv"]')
    reading = [(key, _option(given, key, where)) for key in READING if key in given]
    usual = FleetFitSettings()
    job, searched = (
        _effects(given, key, where) if key in given else getattr(usual, key) for key in ("job", "searched")
    )
    cutoff = given.get("cutoff")
    if cutoff is not None and (
        not isinstance(cutoff, int | float) or isinstance(cutoff, bool) or cutoff <= 0
    ):
        raise FleetError(f"{where}: cutoff must be a number above 0 [Hz], given {cutoff!r}")
    return FleetRobot(
        name,
        _description(given, folder, where),
        tuple(str(folder / pattern) for pattern in logs),
        _file(given, "model", folder, where),
        _file(given, "gains", folder, where),
        tuple(reading),
        tuple(_recorded(given.get("recorded", {}), where)),
        FleetFitSettings(job, searched, cutoff),
    )


def _description(given: Mapping[str, Any], folder: Path, where: str) -> str:
    """Return the name of the catalogue, or the path of the URDF."""
    robot = given.get("robot")
    if not isinstance(robot, str) or not robot:
        raise FleetError(f'{where}: states no robot; write robot = "ur5", or the path of a URDF')
    return str(folder / robot) if (folder / robot).is_file() else robot


def _file(given: Mapping[str, Any], key: str, folder: Path, where: str) -> Path | None:
    if key not in given:
        return None
    if not isinstance(given[key], str):
        raise FleetError(f"{where}: {key} must be the path of a file, given {given[key]!r}")
    path = folder / str(given[key])
    if not path.is_file():
        raise FleetError(f"{where}: there is no {key} {path}")
    return path


def _texts(given: Mapping[str, Any], key: str, where: str) -> tuple[str, ...]:
    value = given.get(key, [])
    texts = [value] if isinstance(value, str) else value
    if not isinstance(texts, Sequence) or not all(isinstance(t, str) and t for t in texts):
        raise FleetError(f"{where}: {key} must be a text or a list of texts, given {value!r}")
    return tuple(texts)


def _option(given: Mapping[str, Any], key: str, where: str) -> str | tuple[str, ...]:
    """Return an option of reading logs as the command line has it: one text, or several."""
    texts = _texts(given, key, where)
    return texts[0] if key in ("format", "torque_side") and len(texts) == 1 else texts


def _effects(given: Mapping[str, Any], key: str, where: str) -> tuple[str, ...]:
    names = _texts(given, key, where)
    for name in names:
        if name not in EFFECTS:
            raise FleetError(f"{where}, {key}: {unknown_name('effect', name, EFFECTS)}")
        of_joint = len(EFFECTS[name].scope_fields) == 1
        if EFFECTS[name].shape or (key == "searched" and not of_joint):
            raise FleetError(
                f"{where}, {key}: '{name}' has a shape or several joints, so one log cannot size it"
            )
    return names


def _recorded(given: Any, where: str) -> list[tuple[str, datetime]]:
    if not isinstance(given, Mapping):
        raise FleetError(f'{where}: recorded must be a table {{"LOG" = DATE}}, given {given!r}')
    out = []
    for pattern, at in given.items():
        if not isinstance(at, date):  # which a datetime is too
            raise FleetError(
                f"{where}: recorded.'{pattern}' must be a date such as 2026-05-12T14:30:00 without quotes, given {at!r}"
            )
        out.append((pattern, at if isinstance(at, datetime) else datetime.combine(at, time())))
    return out
