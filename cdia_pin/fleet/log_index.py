"""The hashes of logs that have not changed since they were hashed, so that a nightly command need not read them all.

    DIR/hashes.json      state of the files and hash, by the path of the log

A hash counts only while path, size, inode, time of the last write and time of the last change of all files of a log are
those that were seen before it was made. The time of change cannot be set back as that of a write can. A file that was
written a moment before may be written again at what its clock shows as the same time, so its hash is not kept. In every
doubt the log is hashed: the index, or a part of it, may be lost at any time.
"""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cdia_pin.input_files import read_text, resolved
from cdia_pin.logs.readers.checksum import sha256_of
from cdia_pin.whole_files import write_whole

INDEX = "hashes.json"
DIGITS = 64  # of a SHA-256 [1]
SETTLED = 10.0  # [s] since the last change: more than a file system's clock resolves, or two clocks differ

State = list[list[Any]]  # of each file: path, size [B], inode, time of writing and of change [ns]


class LogIndex:
    """The hashes of logs in the folder of a store.

    Args:
        folder: Of the store.
    """

    def __init__(self, folder: Path) -> None:
        self._file = folder / INDEX
        self._known = _read(self._file)
        self._new = False

    def sha256_of(self, log: Path) -> str:
        """Return the hash of a log's bytes; its files are read only if they may have changed.

        Args:
            log: Its path; a folder is the files in it.

        Raises:
            OSError: If it cannot be read.
        """
        files = sorted(p for p in log.rglob("*") if p.is_file()) if log.is_dir() else [log]
        path, state, now = str(resolved(log)), _state(files), time.time()
        if path in self._known and self._known[path][0] == state:
            return self._known[path][1]
        found = sha256_of(files)
        changed = max((row[-1] for row in state), default=0) / 1e9
        if changed < now - SETTLED and _state(files) == state:
            self._known[path] = (state, found)
            self._new = True
        return found

    def write(self) -> None:
        """Write the index, if there is anything new; where it cannot be written, logs are hashed again."""
        if self._new:
            try:
                write_whole(self._file, json.dumps(self._known))
            except OSError:
                return


def _state(files: Sequence[Path]) -> State:
    seen = ((str(f), f.stat()) for f in files)
    return [[name, s.st_size, s.st_ino, s.st_mtime_ns, s.st_ctime_ns] for name, s in seen]


def _read(file: Path) -> dict[str, tuple[State, str]]:
    """Return what an index holds; nothing if there is none, or it is damaged."""
    try:
        document = json.loads(read_text(file))
        return {path: (state, sha256) for path, (state, sha256) in document.items() if len(sha256) == DIGITS}
    except (OSError, ValueError, TypeError, AttributeError):
        return {}
