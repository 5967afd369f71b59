"""Robots that are known by name, and the loader of any fixed-base arm from a URDF file."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import sys
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from cdia_pin.errors import RobotError, unknown_name
from cdia_pin.input_files import resolved
from cdia_pin.phrases import shortened
from cdia_pin.resources import robots_dir
from cdia_pin.robot.checks import description_warnings
from cdia_pin.robot.fetched import fetched_urdf, known_urdf
from cdia_pin.robot.locked_joints import LockRequest, LockRule, locked_joints, require_chain
from cdia_pin.robot.model import RobotModel
from cdia_pin.robot.parser_input import parser_input
from cdia_pin.robot.urdf import MOVABLE, Urdf, read_urdf
from cdia_pin.robot.urdf_edit import text_of
from cdia_pin.robot.urdf_values import welded

STANDARD_GRAVITY = 9.81  # [m/s²], the value that Pinocchio takes by default


class RobotSource(StrEnum):
    """Place from which a robot of the catalogue is read."""

    SHIPS = "ships"  # a file of this package
    EXAMPLE_ROBOT_DATA = "example-robot-data"  # a file of the package example-robot-data
    FETCHED = "robot_descriptions"  # fetched at its first use, by the package robot_descriptions


@dataclass(frozen=True)
class LimitRule:
    """Limits that a URDF does not state; None keeps the URDF's limit.

    Attributes:
        joints: Names, or patterns of names.
        why: Source of the numbers.
        lower: Smallest position [rad or m].
        upper: Largest position [rad or m].
        velocity: Largest speed [rad/s or m/s].
        effort: Largest torque or force [N·m or N].
    """

    joints: tuple[str, ...]
    why: str
    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None


@dataclass(frozen=True)
class CatalogueEntry:
    """A robot of ``robots.toml``; the head of that file explains every key.

    Attributes:
        name: Name that ``--robot`` takes.
        description: Kind of robot, in a few words.
        source: Place from which it is read.
        urdf: File, relative to the folder of the source; of a fetched robot, the module of robot_descriptions.
        licence: Licence of the description.
        origin: Authors or repository of the description.
        tool_frame: Frame that carries a payload.
        gravity: Size of gravity [m/s²], along −z of the base.
        lock: Joints that are locked.
        limits: Limits that the file does not state.
        arguments: Arguments of the xacro file of a fetched robot.
        joints: Number of joints of a fetched robot, which is known before it is fetched.
    """

    name: str
    description: str
    source: RobotSource
    urdf: str
    licence: str
    origin: str
    tool_frame: str
    gravity: float = STANDARD_GRAVITY
    lock: tuple[LockRule, ...] = ()
    limits: tuple[LimitRule, ...] = ()
    arguments: Mapping[str, str] = field(default_factory=dict)
    joints: int | None = None

    def __repr__(self) -> str:
        return f"CatalogueEntry({shortened(self.name)}, {self.source.value}, urdf={shortened(self.urdf)})"

    @property
    def path(self) -> Path:
        """The URDF file on this machine.

        Raises:
            RobotError: If the package that holds it is not installed, or it cannot be fetched.
        """
        if self.source is RobotSource.FETCHED:
            return fetched_urdf(self.name, self.urdf, self.arguments, self.origin)
        folder = robots_dir() if self.source is RobotSource.SHIPS else example_robots_dir()
        return folder / self.urdf

    @property
    def available(self) -> bool:
        """True if the description is on this machine, so that it can be loaded without a network."""
        if self.source is RobotSource.FETCHED:
            return known_urdf(self.name) is not None
        try:
            return self.path.is_file()
        except RobotError:
            return False


@cache
def catalogue() -> dict[str, CatalogueEntry]:
    """Return every robot that is known by name, in the order of ``robots.toml``."""
    with (robots_dir() / "robots.toml").open("rb") as file:
        tables = tomllib.load(file)
    return {name: _entry(name, table) for name, table in tables.items()}


def load_robot(
    name_or_path: str | Path,
    *,
    lock: LockRequest = (),
    keep: Iterable[str] = (),
    tool_frame: str | None = None,
    gravity: float | ArrayLike | None = None,
    package_dirs: Sequence[str | Path] = (),
) -> RobotModel:
    """Load a fixed-base arm by its name in the catalogue or from a URDF file.

    Mimic joints are always locked: they have no torque of their own. Joints at the tips that are named like
    fingers, grippers or wheels are locked too. ``robot.locked`` gives each locked joint, its position and the reason.

    Args:
        name_or_path: ``ur5``, or a path to a ``.urdf`` file.
        lock: More joints to lock, names or patterns (``right_*``); a mapping gives positions [rad or m], None for zero
            or the nearest to it.
        keep: Joints that move although they are named like a finger or a wheel, or are locked by the catalogue.
        tool_frame: Frame that carries a payload; if omitted, that of the catalogue, else a likely one.
        gravity: Size along −z [m/s²], or the vector in the base frame, shape (3,). If omitted, that of the
            catalogue, else 9.81 m/s².
        package_dirs: Folders in which ``package://`` addresses of meshes resolve.

    Returns:
        The arm; ``robot.warnings`` lists what is doubtful in its description.

    Raises:
        RobotError: If the name is unknown, the file cannot be used, or the moving joints branch.
    """
    entry = _find(name_or_path)
    path = entry.path if entry else Path(name_or_path).expanduser()
    name = entry.name if entry else path.stem
    urdf = read_urdf(path)
    held = locked_joints(urdf, lock=lock, keep=keep, rules=entry.lock if entry else ())
    require_chain(urdf, held)
    model = _build(urdf, {joint: at.position for joint, at in held.items()})
    if entry:
        _apply_limits(model, entry.limits)
    if gravity is None:
        gravity = entry.gravity if entry else STANDARD_GRAVITY
    model.gravity.linear = _gravity(gravity)
    # RobotModel refuses a robot without moving joints, with a clearer message than these checks would give.
    warnings = description_warnings(urdf, model, held) if model.nv else []
    return RobotModel(
        model,
        name=name,
        urdf=resolved(path),
        tool_frame=tool_frame or (entry.tool_frame if entry else None),
        locked=held,
        package_dirs=[*map(Path, package_dirs), *_package_dirs(path)],
        warnings=warnings,
    )


def robots_here() -> Iterator[RobotModel]:
    """Yield every robot of the catalogue that is on this machine; one whose file was damaged is left out."""
    for name, entry in catalogue().items():
        if not entry.available:
            continue
        try:
            robot = load_robot(name)
        except RobotError:
            continue
        yield robot


def joints_here() -> Iterator[tuple[str, frozenset[str]]]:
    """Yield name and moving joints of every robot of `robots_here`, by their files alone, without a model."""
    for name, entry in catalogue().items():
        if not entry.available:
            continue
        with contextlib.suppress(RobotError):
            urdf = read_urdf(entry.path)
            held = locked_joints(urdf, rules=entry.lock)
            yield name, frozenset(j for j, of in urdf.joints.items() if of.kind in MOVABLE and j not in held)


@cache
def example_robots_dir() -> Path:
    """Find the folder of the robots that the package example-robot-data installs.

    Returns:
        The folder ``share/example-robot-data/robots``.

    Raises:
        RobotError: If that package is not installed.
    """
    inside = Path("share/example-robot-data/robots")
    # The wheel puts its data beside lib/pythonX.Y/site-packages. Its own getModelPath returns a folder of
    # the machine that built it.
    modules = [importlib.util.find_spec(module) for module in ("example_robot_data", "pinocchio")]
    origins = [Path(spec.origin) for spec in modules if spec and spec.origin]
    prefixes = [p for origin in origins for p in origin.parents] + [Path(sys.prefix)]
    for prefix in prefixes:
        if (prefix / inside).is_dir():
            return prefix / inside
    raise RobotError(
        "the package example-robot-data-loaders is missing: pip install example-robot-data-loaders"
    )


def _find(name_or_path: str | Path) -> CatalogueEntry | None:
    """Return the entry of the catalogue, or None for a path."""
    given = str(name_or_path)
    if given in catalogue():
        return catalogue()[given]
    if Path(given).suffix or os.sep in given or Path(given).is_file():
        return None
    raise RobotError(unknown_name("robot", given, catalogue()) + "; or give the path of a .urdf file")


def _build(urdf: Urdf, held: dict[str, float]) -> pin.Model:
    """Build Pinocchio's model with the locked joints welded at their positions."""
    wide = [name for name in held if urdf.joints[name].kind not in MOVABLE]
    if wide:
        raise RobotError(
            f"{urdf.path}: joint '{wide[0]}' is {urdf.joints[wide[0]].kind}: make it fixed in the file"
        )
    try:
        return pin.buildModelFromXML(text_of(welded(parser_input(urdf.tree), held)))
    except (ValueError, RuntimeError) as error:
        raise RobotError(f"{urdf.path}: Pinocchio cannot read this file ({error})") from None


def _apply_limits(model: pin.Model, rules: Iterable[LimitRule]) -> None:
    for rule in rules:
        for i, joint in enumerate(model.joints):
            if not any(fnmatchcase(model.names[i], pattern) for pattern in rule.joints):
                continue
            if rule.lower is not None and rule.upper is not None:
                model.lowerPositionLimit[joint.idx_q] = rule.lower
                model.upperPositionLimit[joint.idx_q] = rule.upper
            if rule.velocity is not None:
                model.velocityLimit[joint.idx_v] = rule.velocity
            if rule.effort is not None:
                model.effortLimit[joint.idx_v] = rule.effort


def _gravity(gravity: float | ArrayLike) -> np.ndarray:
    g = np.asarray(gravity, dtype=np.float64)
    vector = np.array([0.0, 0.0, -float(g)]) if g.ndim == 0 else g
    if vector.shape != (3,) or not np.all(np.isfinite(vector)):
        raise RobotError(f"gravity is a size [m/s²] or a vector of three, given {gravity!r}")
    return vector


def _package_dirs(path: Path) -> list[Path]:
    """List the folders that ``package://`` may mean: those above the file, of ROS, of example-robot-data."""
    ros = [Path(p) for p in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if p]
    ament = [Path(p) / "share" for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    found = [*list(resolved(path).parents)[:4], *ros, *ament]
    with contextlib.suppress(RobotError):  # a file of the user does not need that package
        found.append(example_robots_dir().parents[1])  # share/, for package://example-robot-data/robots/...
    return list(dict.fromkeys(found))


def _entry(name: str, table: dict[str, Any]) -> CatalogueEntry:
    lock = tuple(LockRule(tuple(r["joints"]), float(r["position"]), r["why"]) for r in table.pop("lock", ()))
    limits = tuple(LimitRule(**{**r, "joints": tuple(r["joints"])}) for r in table.pop("limits", ()))
    source = RobotSource(table.pop("source"))
    return CatalogueEntry(name=name, source=source, lock=lock, limits=limits, **table)
