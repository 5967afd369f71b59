"""Reader of Parquet files with one column per signal and joint."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cdia_pin.errors import LogError
from cdia_pin.logs.readers.arrow import table_from_arrow
from cdia_pin.logs.readers.bounds import require_bounded
from cdia_pin.logs.readers.table import Table

if TYPE_CHECKING:
    from pyarrow import parquet


def read_parquet(data: bytes, source: str) -> Table:
    """Read a Parquet file.

    Args:
        data: Bytes of the file.
        source: Its name, for messages.

    Returns:
        The columns as numbers.

    Raises:
        LogError: If the bytes are not Parquet.
    """
    import pyarrow as pa
    from pyarrow import parquet

    try:
        file = parquet.ParquetFile(pa.BufferReader(data))
        require_bounded(_contents(file.metadata), len(data), source)
        arrow = file.read()
    except (pa.ArrowException, OSError, ValueError) as error:
        raise LogError(f"{source}: not readable as Parquet ({' '.join(str(error).split())[:160]})") from None
    return table_from_arrow(arrow, source)


def _contents(metadata: parquet.FileMetaData) -> int:
    """Return the size in memory [B]: runs and dictionaries repeat a value at no cost in the file."""
    stored = sum(metadata.row_group(k).total_byte_size for k in range(metadata.num_row_groups))
    return int(max(stored, 8 * metadata.num_rows * metadata.num_columns))
