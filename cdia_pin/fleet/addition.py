"""The addition of logs to a store."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cdia_pin import schemas
from cdia_pin.cluster import run_each
from cdia_pin.errors import LogError
from cdia_pin.fleet.fleet_map import FleetMap
from cdia_pin.fleet.log_index import LogIndex
from cdia_pin.fleet.log_rows import FleetLog, failure_rows, rows_of
from cdia_pin.fleet.robot_setup import load_setup
from cdia_pin.fleet.store import FleetStore
from cdia_pin.progress import Progress, silent


@dataclass(frozen=True)
class FleetAddition:
    """What came of adding logs.

    Attributes:
        added: Names of the logs that were fitted; paths where several logs have the same name.
        known: Those of the logs that the store had already.
        failed: Reason by name or path of the log that gave nothing.
    """

    added: tuple[str, ...]
    known: tuple[str, ...]
    failed: dict[str, str]

    def to_dict(self) -> dict[str, object]:
        """Return what was done for JSON."""
        return {
            "schema": schemas.FLEET,
            "added": [*self.added],
            "known": [*self.known],
            "failed": self.failed,
        }


def add_logs(
    store: FleetStore,
    fleet: FleetMap,
    logs: Sequence[str | Path] = (),
    *,
    retry: bool = False,
    workers: int | None = 1,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> FleetAddition:
    """Add logs to a store: each is checked, compared with its robot's model, fitted and searched.

    A log that the store has already changes nothing. Each log is in the store as soon as it is done.

    Args:
        store: The store.
        fleet: The robots, and which logs are theirs.
        logs: Files of logs; all that the map finds if empty.
        retry: Whether logs that failed before are tried again.
        workers: Number of processes on this machine; one a core if None. One is this process itself, which needs no
            ``if __name__ == "__main__":`` in a script.
        scheduler: Address of a running scheduler of Dask, whose workers do the work in place of this process.
        progress: Called with a sentence and the share done, from 0 to 1.

    Raises:
        FleetError: If a log is of no robot, or the store cannot be written.
        LogError: If a log is not there.
        CdiaError: If a robot of the map cannot be loaded.
    """
    tell = progress or silent
    wanted, known = [], []
    paths = list(dict.fromkeys(map(Path, logs or fleet.logs)))
    names, index = _told_apart(paths), LogIndex(store.folder)
    for path in paths:
        tell(f"looking at {path.name}", 0.0)
        log = _fleet_log(path, fleet, index)
        file = store.file_of(log.robot.name, log.sha256, load_setup(log.robot).hash)
        if file.exists() and not (retry and _failed(file)):
            known.append(names[path])
        else:
            wanted.append(log)
    index.write()
    added, failed = [], {}
    workers = None if scheduler and workers == 1 else workers
    for one in run_each(rows_of, wanted, workers=workers, scheduler=scheduler, progress=tell):
        name = names[one.item.path]
        rows = one.result if one.error is None else failure_rows(one.item, one.why)
        store.write(rows)
        if rows[0]["failure"]:
            failed[name] = str(rows[0]["failure"])
        else:
            added.append(name)
    return FleetAddition(tuple(added), tuple(known), failed)


def _told_apart(paths: Sequence[Path]) -> dict[Path, str]:
    """Return the name of each file, or its path where another one has the same name."""
    times = Counter(path.name for path in paths)
    return {path: path.name if times[path.name] == 1 else str(path) for path in paths}


def _fleet_log(path: Path, fleet: FleetMap, index: LogIndex) -> FleetLog:
    """Return a log with its robot and hash."""
    if not path.exists():
        raise LogError(f"there is no log {path}")
    robot = fleet.robot_of(path)
    try:
        return FleetLog(path, robot, index.sha256_of(path))
    except OSError as error:
        raise LogError(f"cannot read {path}: {error.strerror}") from None


def _failed(file: Path) -> bool:
    from pyarrow import parquet

    return any(parquet.read_table(file, columns=["failure"])["failure"].to_pylist())
