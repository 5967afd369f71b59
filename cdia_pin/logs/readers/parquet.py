"""Reader of Parquet files with one column per signal and joint."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from cdia_pin.errors import LogError
from cdia_pin.logs.readers.arrow_batches import ROWS, table_from_batches
from cdia_pin.logs.readers.bounds import require_bounded
from cdia_pin.logs.readers.table import Table

if TYPE_CHECKING:
    from pyarrow import parquet


def read_parquet(path: Path) -> Table:
    """Read a Parquet file, a batch of rows at a time.

    Args:
        path: The file.

    Returns:
        The columns as numbers.

    Raises:
        LogError: If the file is not Parquet.
    """
    import pyarrow as pa
    from pyarrow import parquet

    source = path.name
    try:
        with parquet.ParquetFile(path) as file:
            require_bounded(_contents(file.metadata), path.stat().st_size, source)
            return table_from_batches(file.iter_batches(ROWS), file.schema_arrow, source)
    except (pa.ArrowException, OSError, ValueError) as error:
        raise LogError(f"{source}: not readable as Parquet ({' '.join(str(error).split())[:160]})") from None


def _contents(metadata: parquet.FileMetaData) -> int:
    """Return the size in memory [B]: runs and dictionaries repeat a value at no cost in the file."""
    stored = sum(metadata.row_group(k).total_byte_size for k in range(metadata.num_row_groups))
    return int(max(stored, 8 * metadata.num_rows * metadata.num_columns))
