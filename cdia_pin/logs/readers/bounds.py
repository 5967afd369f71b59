"""How large the contents of a compressed log may be: known before they are read, and bounded."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import TYPE_CHECKING

from cdia_pin.errors import LogError

if TYPE_CHECKING:
    from pyarrow import parquet

ALWAYS = 64 * 2**20  # [B], contents that any file may have: an hour of an arm at 125 Hz
GROWTH = 100  # [1], contents over the size of the file; measured signals shrink to a tenth at best
VECTOR = re.compile(r"\.(?:list|bag|array)\b.*")  # after the name of a column of vectors, as Parquet knows it
MOST = 8 * 2**30  # [B], contents of any file


def require_bounded(contents: int, size: int, source: str) -> None:
    """Refuse a file whose contents are out of all proportion to its size.

    Args:
        contents: Size of its contents when they are decompressed [B].
        size: Size of the file [B].
        source: Its name, for messages.

    Raises:
        LogError: If the contents are too large.
    """
    most = min(MOST, max(ALWAYS, GROWTH * size))
    if contents > most:
        raise LogError(
            f"{source}: its {size / 1e6:.3g} MB would become {contents / 1e6:.3g} MB when they are decompressed; "
            f"{most / 1e6:.3g} MB are read at most"
        )


def parquet_contents(metadata: parquet.FileMetaData, names: Collection[str]) -> int:
    """Return the size of columns of a Parquet file in memory [B].

    Runs and dictionaries repeat a value at no cost in the file, so the number of values counts.

    Args:
        metadata: Of the file.
        names: Columns of numbers or of vectors.
    """
    wanted = set(names)
    groups = (metadata.row_group(k) for k in range(metadata.num_row_groups))
    return sum(
        max(column.total_uncompressed_size, 8 * column.num_values)
        for group in groups
        for column in map(group.column, range(group.num_columns))
        if {column.path_in_schema, VECTOR.sub("", column.path_in_schema)} & wanted
    )
