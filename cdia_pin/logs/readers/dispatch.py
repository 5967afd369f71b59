"""Choice of the reader by the format, the suffix of a file and what lies beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from cdia_pin.errors import LogError
from cdia_pin.logs.formats import CSV, LEROBOT, ROS2
from cdia_pin.logs.readers.bag_files import (
    BAG_SUFFIXES,
    COMPRESSED,
    METADATA,
    require_plain_files,
    storage_files,
)
from cdia_pin.logs.readers.checksum import sha256_of
from cdia_pin.logs.readers.lerobot import dataset_of, read_lerobot
from cdia_pin.logs.readers.table import Table

LONG = (
    32 * 2**20
)  # [B], of a text that is read in blocks if it is a plain one: a minute of an arm at 1 kHz has 10 MB
SUFFIXES = (".csv", ".tsv", ".txt", ".parquet", ".pq", ".npz", *BAG_SUFFIXES)


@dataclass(frozen=True)
class Wanted:
    """What of a file is wanted, as far as the user says it.

    Attributes:
        format: Name of the format.
        joint_map: {name in the log: joint of the robot}.
        topic: Topic of a bag.
        episode: Episode of a LeRobot dataset.
    """

    format: str | None = None
    joint_map: Mapping[str, str] = field(default_factory=dict)
    topic: str | None = None
    episode: int | None = None


def read_table(path: Path, joints: Sequence[str], wanted: Wanted) -> tuple[Table, str]:
    """Read a file with the reader of its format, or else of its suffix.

    Args:
        path: The file, the directory of a ROS 2 bag or that of a LeRobot dataset.
        joints: Joints of the robot, by which the topic of a bag is chosen.
        wanted: What of it is wanted.

    Returns:
        The table, and the SHA-256 of the file's bytes (of a bag or dataset, of the files that were read).

    Raises:
        LogError: If there is no such file, its format is unknown or it cannot be read.
    """
    source = path.name
    if not path.exists():
        raise LogError(f"{path}: no such file")
    if not (path.is_file() or path.is_dir()):
        raise LogError(f"{path}: a pipe or a device, expected a file")
    suffix = path.suffix.lower()
    if _is_lerobot(path, wanted):
        return read_lerobot(path, wanted.episode)
    if wanted.episode is not None:
        raise LogError(f"{source}: only a LeRobot dataset has episodes, given --episode {wanted.episode}")
    if path.is_dir() or suffix in {*BAG_SUFFIXES, COMPRESSED} or wanted.format == ROS2.name:
        return _bag(path, joints, wanted)
    if suffix not in SUFFIXES and wanted.format is None:
        hint = "; ROS 1 bags become ROS 2 bags with rosbags-convert" if suffix == ".bag" else ""
        raise LogError(
            f"{source}: unknown log format '{suffix or 'no suffix'}'; known: {', '.join(SUFFIXES)} "
            f"or the directory of a ROS 2 bag or of a LeRobot dataset{hint}; --format {CSV.name} reads any text"
        )
    try:
        digest = sha256_of([path])
        if not path.stat().st_size:
            raise LogError(f"{source}: the file is empty")
        if suffix in {".parquet", ".pq"}:
            from cdia_pin.logs.readers.parquet import read_parquet

            return read_parquet(path), digest
        if suffix != ".npz" and path.stat().st_size > LONG:
            from cdia_pin.logs.readers.long_csv import read_long_csv

            table = read_long_csv(path)
            if table is not None:
                return table, digest
        data = path.read_bytes()
    except OSError as error:
        raise LogError(f"{path}: cannot be read ({error.strerror})") from None
    if suffix == ".npz":
        from cdia_pin.logs.readers.npz import read_npz

        return read_npz(data, source), digest
    from cdia_pin.logs.readers.csv import read_csv

    return read_csv(data, source, joints), digest


def _is_lerobot(path: Path, wanted: Wanted) -> bool:
    """Tell whether a path is that of a LeRobot dataset; a format that the user names decides."""
    if wanted.format is not None:
        return wanted.format == LEROBOT.name
    return (path.is_dir() or path.suffix.lower() == ".parquet") and dataset_of(path) is not None


def _bag(path: Path, joints: Sequence[str], wanted: Wanted) -> tuple[Table, str]:
    """Read a bag, or the only storage file of a directory that has no metadata."""
    from cdia_pin.logs.readers.rosbag import read_rosbag

    files = storage_files(path)
    if not files:
        raise LogError(f"{path}: a directory without .db3 or .mcap files is not a ROS 2 bag")
    try:
        require_plain_files(path)
        if path.is_dir() and not (path / METADATA).exists():
            if len(files) > 1:
                raise LogError(f"{path}: no {METADATA} and several storage files; give one of them")
            path = files[0]
        digest = sha256_of(files)
    except OSError as error:
        raise LogError(f"{path}: cannot be read ({error.strerror})") from None
    table = read_rosbag(path, joints, wanted.joint_map, wanted.topic)
    return table, digest
