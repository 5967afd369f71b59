"""Reader of Parquet files with one column per signal and joint."""

from __future__ import annotations

from pathlib import Path

from cdia_pin.decoding import decoding
from cdia_pin.errors import LogError
from cdia_pin.logs.readers.arrow_batches import ROWS, table_from_batches
from cdia_pin.logs.readers.bounds import parquet_contents, require_bounded
from cdia_pin.logs.readers.table import Table

BUFFER = (
    2**20
)  # [B] of each column that are read at once; Arrow would hold a whole row group beside its numbers


def read_parquet(path: Path) -> Table:
    """Read a Parquet file, a batch of rows at a time.

    Args:
        path: The file.

    Returns:
        The columns as numbers.

    Raises:
        LogError: If the file is not Parquet.
    """
    from pyarrow import parquet

    source = path.name
    with (
        decoding(lambda said: LogError(f"{source}: not readable as Parquet ({said})")),
        parquet.ParquetFile(path, pre_buffer=False, buffer_size=BUFFER) as file,
    ):
        contents = parquet_contents(file.metadata, file.schema_arrow.names)
        require_bounded(contents, path.stat().st_size, source)
        return table_from_batches(
            file.iter_batches(ROWS), file.schema_arrow, source, rows=file.metadata.num_rows
        )
