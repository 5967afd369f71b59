"""The store of a fleet: a folder of Parquet files, one for each log of each robot.

    DIR/cdia-fleet.json              schema, version, and what the columns mean
    DIR/rows/ROBOT/*.parquet         the rows of one log each
    DIR/hashes.json                  hashes of logs that need not be read again: see `log_index`

A file is written whole or not at all, so an interrupted run loses the log at hand only. Its name holds the hashes of
the log and of the robot's setup, and the version, so a log that was added before is known without being read. Another
version may fit otherwise, so it fits the logs again.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Self

from cdia_pin import schemas
from cdia_pin.fleet.columns import COLUMNS, arrow_schema
from cdia_pin.fleet.fleet_map import FleetError
from cdia_pin.fleet.log_rows import Row
from cdia_pin.input_files import read_text
from cdia_pin.version import __version__
from cdia_pin.whole_files import whole_file, write_whole

if TYPE_CHECKING:
    import pyarrow as pa

MARK, ROWS = "cdia-fleet.json", "rows"
DIGITS = 20  # of each hash that a file's name holds [1]; 80 bits do not meet by chance


@dataclass(frozen=True)
class FleetStore:
    """A store that was opened or made.

    Attributes:
        folder: Its folder.
    """

    folder: Path

    @classmethod
    def at(cls, folder: str | Path, *, make: bool = False) -> Self:
        """Open a store.

        Args:
            folder: Its folder.
            make: Whether it is made where there is none.

        Raises:
            FleetError: If there is none, if the folder holds something else, or it cannot be made.
        """
        folder = Path(folder)
        mark = folder / MARK
        try:
            if mark.is_file():
                document = json.loads(read_text(mark))
            elif not make:
                raise FleetError(
                    f"{folder} is no store of a fleet: cdia fleet add LOG --store {folder} makes one"
                )
            elif folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
                raise FleetError(f"{folder} is not empty and no store of a fleet: give a new folder")
            else:
                (folder / ROWS).mkdir(parents=True, exist_ok=True)
                write_whole(mark, _mark())
                return cls(folder)
        except OSError as error:
            raise FleetError(f"cannot use the store {folder}: {error.strerror}") from None
        except ValueError:
            raise FleetError(f"{mark} is damaged: it must be JSON") from None
        found = document.get("schema") if isinstance(document, dict) else None
        if found != schemas.FLEET:
            raise FleetError(
                f"{folder} has schema '{found}', this version of cdia-pin reads '{schemas.FLEET}'"
            )
        return cls(folder)

    def file_of(self, robot: str, log_hash: str, setup_hash: str, version: str = __version__) -> Path:
        """Return the file of the rows of a log.

        Args:
            robot: Name of its robot.
            log_hash: Hash of its bytes.
            setup_hash: Hash of the robot's setup.
            version: Version of cdia-pin that makes them.
        """
        name = f"{log_hash[:DIGITS]}-{setup_hash[:DIGITS]}-{version}.parquet"
        return self.folder / ROWS / robot / name

    def write(self, rows: Sequence[Row]) -> Path:
        """Write the rows of one log; the same log again replaces them.

        Args:
            rows: Rows of one log, at least one.

        Returns:
            The file.

        Raises:
            FleetError: If it cannot be written.
        """
        import pyarrow as pa
        from pyarrow import parquet

        first = rows[0]
        made_by = str(first["version"] or __version__)
        path = self.file_of(str(first["robot"]), str(first["sha256"]), str(first["setup"]), made_by)
        table = pa.Table.from_pylist(
            list(rows), arrow_schema({"schema": schemas.FLEET, "version": __version__})
        )
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with whole_file(path) as file:
                parquet.write_table(table, file)
        except OSError as error:
            raise FleetError(f"cannot write {path}: {error.strerror}") from None
        return path

    def table(self, columns: Iterable[str] | None = None) -> pa.Table:
        """Return all rows.

        Args:
            columns: Names of the columns; all if None.

        Raises:
            FleetError: If a file is damaged.
        """
        import pyarrow as pa
        from pyarrow import dataset

        names = list(COLUMNS if columns is None else columns)
        schema = arrow_schema({"schema": schemas.FLEET})
        files = sorted(str(p) for p in (self.folder / ROWS).glob("*/*.parquet"))
        if not files:
            return schema.empty_table().select(names)
        try:
            return dataset.dataset(files, schema=schema, format="parquet").to_table(columns=names)
        except (pa.ArrowException, OSError) as error:
            raise FleetError(f"the store {self.folder} cannot be read: {error}") from None


def _mark() -> str:
    """Return what the store says of itself."""
    columns = {
        name: {"type": kind, "unit": unit, "meaning": text} for name, (kind, unit, text) in COLUMNS.items()
    }
    document = {
        "schema": schemas.FLEET,
        "version": __version__,
        "rows": f"{ROWS}/*/*.parquet",
        "columns": columns,
    }
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"
