"""Files of a ROS 2 bag: which of them hold messages, and whether they are compressed as a whole."""

from __future__ import annotations

import re
from pathlib import Path

from cdia_pin.errors import LogError

BAG_SUFFIXES = (".db3", ".mcap")
METADATA = "metadata.yaml"
COMPRESSED = ".zstd"  # after the suffix of a file that was compressed as a whole
WHOLE_FILES = re.compile(
    r"compression_mode:[\s\"']*file", re.IGNORECASE
)  # in the metadata, where files are compressed


def storage_files(path: Path) -> list[Path]:
    """Return the files of a bag that hold messages, also compressed ones, in the order of their numbers.

    Args:
        path: A storage file, or the directory of a bag.
    """
    if not path.is_dir():
        return [path]
    files = [p for p in path.iterdir() if p.name.removesuffix(COMPRESSED).endswith(BAG_SUFFIXES)]
    return sorted(files, key=lambda p: [int(k) if k.isdigit() else k for k in re.split(r"(\d+)", p.name)])


def is_bag(folder: Path) -> bool:
    """Tell whether a directory is that of a bag.

    Args:
        folder: The directory.
    """
    return (folder / METADATA).exists() and bool(storage_files(folder))


def require_plain_files(path: Path) -> None:
    """Refuse a bag whose files are compressed as a whole: how large they become is not known before.

    Args:
        path: A storage file, or the directory of a bag.

    Raises:
        LogError: If they are.
        OSError: If its metadata cannot be read.
    """
    metadata = path / METADATA
    said = metadata.read_text(errors="replace") if metadata.is_file() else ""
    if WHOLE_FILES.search(said) or any(file.suffix == COMPRESSED for file in storage_files(path)):
        raise LogError(
            f"{path}: its files are compressed as a whole; decompress it first: zstd -d --rm *{COMPRESSED}, "
            "then ros2 bag reindex"
        )
