"""Conversion of Arrow tables to columns of numbers, for the CSV and Parquet readers."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.columns import sort_names
from cdia_pin.logs.readers.table import Table
from cdia_pin.phrases import some

if TYPE_CHECKING:
    import pyarrow as pa


def table_from_arrow(arrow: pa.Table, source: str, notes: tuple[str, ...] = ()) -> Table:
    """Convert an Arrow table; empty cells become NaN, dates become ns since 1970.

    Args:
        arrow: The table, one column per name.
        source: Name of the file, for messages.
        notes: Notes of the reader, which are kept.

    Returns:
        Its columns as numbers.

    Raises:
        LogError: If two columns have the same name.
    """
    import pyarrow as pa

    names = list(arrow.column_names)
    twice = sorted(n for n, count in Counter(names).items() if count > 1)
    if twice:
        raise LogError(f"{source}: columns that appear more than once: {some(twice)}")
    columns: dict[str, NDArray[Any]] = {}
    not_numbers: dict[str, str] = {}
    time_unit = None
    numeric = (pa.types.is_integer, pa.types.is_floating, pa.types.is_decimal)
    for name in names:
        column = arrow[name]
        if pa.types.is_timestamp(column.type) and column.null_count == 0:
            columns[name] = column.cast(pa.timestamp("ns")).cast(pa.int64()).to_numpy()
            time_unit = "ns" if name in sort_names([name]).time else time_unit
        elif pa.types.is_null(column.type):
            columns[name] = np.full(len(column), np.nan)
        elif pa.types.is_integer(column.type) and column.null_count == 0:
            columns[name] = column.to_numpy().astype(np.int64)
        elif any(kind(column.type) for kind in numeric):
            columns[name] = column.cast(pa.float64()).to_numpy()
        else:
            not_numbers[name] = _example(column)
    return Table(columns, not_numbers, time_unit, notes)


def _example(column: pa.ChunkedArray) -> str:
    """Show the first value of a column that is not a number, with its row."""
    for row, value in enumerate(column):
        text = value.as_py()
        try:
            float(text)
        except (TypeError, ValueError):
            if text is not None:
                return f"'{str(text)[:40]}' in sample {row}"
    return f"values of type {column.type}"
