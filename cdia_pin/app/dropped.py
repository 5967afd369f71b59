"""Files that were dropped on the app: what each of them is, and meshes beside the URDF that names them."""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

from lxml import etree

from cdia_pin import schemas
from cdia_pin.decoding import decoding
from cdia_pin.errors import CdiaError, LogError, RobotError
from cdia_pin.input_files import read_text
from cdia_pin.logs.columns import sort_names
from cdia_pin.logs.readers.bag_files import COMPRESSED, METADATA, is_bag
from cdia_pin.logs.readers.csv import column_names
from cdia_pin.logs.readers.dispatch import SUFFIXES
from cdia_pin.logs.readers.lerobot import INFO
from cdia_pin.phrases import some
from cdia_pin.robot.urdf import parse_xml

LARGEST = 500  # [MB], of a file that is dropped
UNPACKED = 2000  # [MB], of what a zip file holds, and of all drops of a session
MOST_FILES = 5000  # of a zip file, and of all drops of a session
MESHES = (".stl", ".dae", ".obj", ".ply", ".glb", ".gltf")
ROBOTS = (".urdf", ".xacro", ".xml")
TEXT = ".txt"
START = 4096  # [B], of a file, by which it is known
USEFUL = (*SUFFIXES, *ROBOTS, *MESHES, ".json", ".zip", ".yaml", COMPRESSED)


@dataclass(frozen=True)
class Dropped:
    """What was found among dropped files; None where there is no such file.

    Attributes:
        robot: A URDF.
        log: A log, or the folder of a bag.
        model: A saved model.
        meshes: Meshes.
        gains: Drive gains [N·m/A] by joint, as their file has them.
    """

    robot: Path | None = None
    log: Path | None = None
    model: Path | None = None
    meshes: tuple[Path, ...] = ()
    gains: Mapping[str, Any] = field(default_factory=dict)


def inside(folder: Path, name: str) -> Path:
    """Return the place of a dropped file below a folder.

    Args:
        folder: Where dropped files go.
        name: Its path as a browser or a zip file names it.

    Raises:
        CdiaError: If the path leads out of the folder.
    """
    path = PurePosixPath(name.replace("\\", "/"))
    if not path.parts or path.is_absolute() or {"..", "."} & set(path.parts) or "\0" in name:
        raise CdiaError(f"a dropped file has the path '{name}', which is none")
    return folder.joinpath(*path.parts)


def sort_dropped(folder: Path) -> Dropped:
    """Tell what dropped files are; zip files are unpacked first.

    Args:
        folder: That holds them.

    Raises:
        CdiaError: If a zip file cannot be unpacked, nothing can be used, or it is not clear which file is meant.
    """
    for packed in _files(folder):
        if packed.suffix.lower() == ".zip":
            _unpack(packed)
    files = _files(folder)
    documents = {
        p: _document(p) for p in files if p.suffix.lower() == ".json" and p.parent.name != INFO.parent.name
    }
    gains = _one("file of drive gains", (p for p, d in documents.items() if _are_gains(d)))
    found = Dropped(
        robot=_one("robot", _robots(files)),
        log=_one("log", _logs(files)),
        model=_one("saved model", (p for p, d in documents.items() if d.get("schema") == schemas.MODEL)),
        meshes=tuple(p for p in files if p.suffix.lower() in MESHES),
        gains=documents[gains] if gains else {},
    )
    if found == Dropped():
        names = some([p.name for p in files])
        raise CdiaError(
            f"nothing to use in {names or 'what was dropped'}: a URDF, a log or drive gains can be"
        )
    return found


def place_meshes(urdf: Path, meshes: Iterable[Path]) -> None:
    """Put meshes where a URDF looks for them: below its own folder, by their names and the folders around them.

    Args:
        urdf: The file.
        meshes: Files; of two with a mesh's name, the one with more folders in common is taken.
    """
    by_name: dict[str, list[Path]] = {}
    for mesh in meshes:
        by_name.setdefault(mesh.name.lower(), []).append(mesh)
    for address in mesh_addresses(urdf):
        wanted = PurePosixPath(address.partition("://")[2] or address)
        candidates = by_name.get(wanted.name.lower(), [])
        target = urdf.parent.joinpath(*wanted.parts)
        if not candidates or wanted.is_absolute() or ".." in wanted.parts or target.exists():
            continue
        best = max(candidates, key=lambda p: _shared_tail(p.parts, wanted.parts))
        with suppress(OSError):  # of a mesh whose folder another mesh is
            target.parent.mkdir(parents=True, exist_ok=True)
            os.link(best, target)


def mesh_addresses(urdf: Path) -> list[str]:
    """Return the addresses of the meshes that a URDF names; empty for a file that is none.

    Args:
        urdf: The file.
    """
    try:
        tree = parse_xml(urdf)
    except (OSError, etree.XMLSyntaxError):  # whoever loads the robot says so
        return []
    return list(dict.fromkeys(str(m.get("filename", "")) for m in tree.getroot().iter("mesh")))


def _shared_tail(one: tuple[str, ...], other: tuple[str, ...]) -> int:
    """Return how many parts at the end of two paths are the same."""
    same = 0
    for a, b in zip(reversed(one), reversed(other), strict=False):
        if a.lower() != b.lower():
            break
        same += 1
    return same


def _robots(files: list[Path]) -> list[Path]:
    """Return the descriptions of robots: URDF files, or else files that must become one."""
    urdfs = [p for p in files if p.suffix.lower() == ".urdf"]
    return urdfs or [p for p in files if p.suffix.lower() in ROBOTS and b"<robot" in _start(p)]


def _files(folder: Path) -> list[Path]:
    """Return the files below a folder, without those that systems put beside them."""

    def hidden(path: Path) -> bool:
        return any(part.startswith(".") or part == "__MACOSX" for part in path.relative_to(folder).parts)

    return sorted(p for p in folder.rglob("*") if p.is_file() and not hidden(p))


def _logs(files: list[Path]) -> list[Path]:
    """Return the logs; a text is one if nothing else is, and if it begins like a table."""
    bags = {p.parent for p in files if p.name == METADATA and is_bag(p.parent)}
    singles = [p for p in files if p.suffix.lower() in SUFFIXES and p.parent not in bags]
    logs = [*bags, *(p for p in singles if p.suffix.lower() != TEXT)]
    return logs or [p for p in singles if _is_table(p)]


def _start(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(START)


def _is_table(text: Path) -> bool:
    """Tell whether the first line of a text has a delimiter or names a column of times."""
    names, delimiter = column_names(_start(text).decode(errors="replace").partition("\n")[0])
    return delimiter != " " or bool(sort_names(names).time)


def _one(what: str, paths: Iterable[Path]) -> Path | None:
    found = list(paths)
    if len(found) > 1:
        raise LogError(
            f"more than one {what} was dropped ({some([p.name for p in found])}): drop one of them"
        )
    return found[0] if found else None


def _document(path: Path) -> dict[str, Any]:
    try:
        document = json.loads(read_text(path))
    except (OSError, ValueError, RecursionError):
        return {}
    return document if isinstance(document, dict) else {}


def _are_gains(document: Mapping[str, Any]) -> bool:
    """Tell whether all that a document says is numbers, each alone or as ``value`` with a tolerance."""
    parts = [
        [v["value"], v.get("tolerance", 0)] if isinstance(v, dict) and "value" in v else [v]
        for v in document.values()
    ]
    numbers = [number for part in parts for number in part]
    return bool(numbers) and all(type(number) in {int, float} for number in numbers)


def _unpack(packed: Path) -> None:
    folder = packed.with_suffix("")
    with (
        decoding(lambda said: RobotError(f"{packed.name}: not a zip file that can be read ({said})")),
        zipfile.ZipFile(packed) as archive,
    ):
        members = [m for m in archive.infolist() if not m.is_dir()]
        size = sum(m.file_size for m in members)
        if size > UNPACKED * 10**6 or len(members) > MOST_FILES:
            raise RobotError(
                f"{packed.name} holds {len(members)} files of {size / 1e6:.0f} MB; "
                f"{MOST_FILES} of {UNPACKED} MB are read at most"
            )
        for member in members:
            target = inside(folder, member.filename)
            target.parent.mkdir(parents=True, exist_ok=True)
            archive.extract(member, folder)
    packed.unlink()
