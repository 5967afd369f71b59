"""Texts that are read whole: models, gains and descriptions of robots, which are files of a bounded size."""

from __future__ import annotations

import errno
import os
from pathlib import Path

LARGEST = 256 * 2**20  # [B], of a text; a model that remembers ten logs has 40 MB


def resolved(path: Path) -> Path:
    """Return where a path leads, through links; one of a loop of links, which `Path.resolve` raises at, leads nowhere.

    Args:
        path: The path.
    """
    return Path(os.path.realpath(path))


def require_small_file(path: str | Path) -> None:
    """Refuse pipes, which may never end, devices, folders and giant files.

    Args:
        path: The file.

    Raises:
        OSError: If it is missing, no file, or too large.
    """
    path = Path(path)
    size = path.stat().st_size
    if path.is_dir():
        raise OSError(errno.EISDIR, "it is a directory", str(path))
    if not path.is_file():
        raise OSError(errno.EINVAL, "a pipe or a device, expected a file", str(path))
    if size > LARGEST:
        raise OSError(errno.EFBIG, f"{size / 1e6:.0f} MB, {LARGEST / 1e6:.0f} MB are read at most", str(path))


def read_text(path: str | Path) -> str:
    """Return the text of a small file.

    Args:
        path: The file, in UTF-8.

    Raises:
        OSError: If it cannot be read, or `require_small_file` refuses it.
        UnicodeDecodeError: If it is not UTF-8.
    """
    require_small_file(path)
    return Path(path).read_text(encoding="utf-8")
