"""Reader of Parquet files with one column per signal and joint."""

from __future__ import annotations

from cdia_pin.errors import LogError
from cdia_pin.logs.readers.arrow import table_from_arrow
from cdia_pin.logs.readers.table import Table


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
        arrow = parquet.read_table(pa.BufferReader(data))
    except (pa.ArrowException, OSError, ValueError) as error:
        raise LogError(f"{source}: not readable as Parquet ({' '.join(str(error).split())[:160]})") from None
    return table_from_arrow(arrow, source)
