"""Files that are written whole or not at all: the one writer of everything that the package leaves on a disk.

What is written goes to a temporary file beside the target, to the disk, and then takes the target's name in one step.
A full disk, a limit, an error or a kill meanwhile leaves the old file as it was.
"""

from __future__ import annotations

import contextlib
import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

USUAL_RIGHTS = 0o666  # of a new file, less the process's umask


@contextmanager
def whole_file(path: str | Path) -> Iterator[IO[bytes]]:
    """Give a binary file that replaces another one when the block ends without an error.

    Symbolic links are followed. Pipes and devices cannot be replaced: they take what is written at once.

    Args:
        path: File to write; an existing one is replaced, and its rights are kept.

    Yields:
        The file to write to.

    Raises:
        OSError: If it cannot be written; the old file is then as it was.
    """
    target = Path(os.path.realpath(path))
    try:
        status: os.stat_result | None = target.stat()
    except FileNotFoundError:
        status = None
    if status is not None and not stat.S_ISREG(status.st_mode):
        with target.open("wb") as device:
            yield device
        return
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name[:100]}.", suffix=".part")
    draft = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            yield file
            file.flush()
            _take_rights(file.fileno(), status)
            os.fsync(file.fileno())
        draft.replace(target)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise
    _keep_name(target.parent)


def write_whole(path: str | Path, content: str | bytes) -> Path:
    """Write a file whole or not at all.

    Args:
        path: File to write; an existing one is replaced.
        content: Its bytes, or its text, which is written as UTF-8.

    Returns:
        The path that was written.

    Raises:
        OSError: If it cannot be written; the old file is then as it was.
    """
    with whole_file(path) as file:
        file.write(content.encode(errors="replace") if isinstance(content, str) else content)
    return Path(path)


def require_place(path: str | Path) -> None:
    """Check that a file can be written, without changing what is there.

    Args:
        path: File that will be written.

    Raises:
        OSError: If it cannot be.
    """
    target = Path(os.path.realpath(path))
    if target.exists():
        target.open("ab").close()
    if not target.exists() or target.is_file():
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name[:100]}.", suffix=".part")
        os.close(handle)
        Path(name).unlink()


def _take_rights(handle: int, status: os.stat_result | None) -> None:
    """Give a new file the usual rights, or those and the owner of the file that it replaces."""
    if status is None:
        mask = os.umask(0)
        os.umask(mask)
        os.fchmod(handle, USUAL_RIGHTS & ~mask)
        return
    with contextlib.suppress(PermissionError):
        os.fchown(handle, status.st_uid, status.st_gid)
    os.fchmod(handle, stat.S_IMODE(status.st_mode))


def _keep_name(folder: Path) -> None:
    """Send the folder to the disk, so that the new name outlives a loss of power; some file systems cannot."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
