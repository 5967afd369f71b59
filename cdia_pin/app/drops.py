"""`Drops`: the files that pages send to a session, in a folder for each drop, bounded."""

from __future__ import annotations

import shutil
from collections import Counter
from pathlib import Path

from cdia_pin.app.dropped import MOST_FILES, UNPACKED, inside
from cdia_pin.errors import CdiaError


class Drops:
    """Files that were dropped on the pages of a session.

    Args:
        folder: For all of them.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._files: Counter[str] = Counter()
        self._bytes: Counter[str] = Counter()

    def place(self, drop: str, path: str) -> Path:
        """Return where a file goes.

        Args:
            drop: Name of the drop.
            path: Of the file in it.

        Raises:
            CdiaError: If it leads elsewhere, or there are too many files.
        """
        file = inside(inside(self._folder, drop), path)
        if self._files.total() >= MOST_FILES:
            raise CdiaError(f"a session takes {MOST_FILES} files at most")
        self._files[drop] += 1
        return file

    def count(self, drop: str, size: int) -> None:
        """Count bytes that have come.

        Args:
            drop: Name of the drop.
            size: How many [B].

        Raises:
            CdiaError: If they are too many.
        """
        self._bytes[drop] += size
        if self._bytes.total() > UNPACKED * 10**6:
            raise CdiaError(f"a session takes {UNPACKED} MB at most, give its path instead")

    def folder(self, drop: str) -> Path:
        """Return the folder of a drop.

        Args:
            drop: Its name.

        Raises:
            CdiaError: If there is none.
        """
        folder = inside(self._folder, drop)
        if not folder.is_dir():
            raise CdiaError("no file has come: drop them again")
        return folder

    def forget(self, drop: str) -> None:
        """Remove the files of a drop that is refused.

        Args:
            drop: Its name.

        Raises:
            CdiaError: If it leads elsewhere.
        """
        shutil.rmtree(inside(self._folder, drop), ignore_errors=True)
        del self._files[drop], self._bytes[drop]
