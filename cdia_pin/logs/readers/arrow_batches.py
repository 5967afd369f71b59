"""Columns of numbers from batches of Arrow rows: memory for the numbers, and for one batch."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.readers.arrow import table_from_arrow
from cdia_pin.logs.readers.table import Table

if TYPE_CHECKING:
    import pyarrow as pa

ROWS = 2**16  # rows of a batch [1]: some ten MB


def table_from_batches(
    batches: Iterable[pa.RecordBatch], schema: pa.Schema, source: str, notes: tuple[str, ...] = ()
) -> Table:
    """Convert batches of rows as `table_from_arrow` converts a table.

    Floating-point numbers are taken over batch by batch. The few other columns are converted at the end, because
    their meaning may depend on all of their values.

    Args:
        batches: Batches of rows.
        schema: Names and types of the columns.
        source: Name of the file, for messages.
        notes: Notes of the reader, which are kept.

    Raises:
        LogError: If two columns have the same name.
    """
    import pyarrow as pa

    table_from_arrow(schema.empty_table(), source)  # refuses repeated names before anything is read
    floating = [f.name for f in schema if pa.types.is_floating(f.type)]
    others = [f.name for f in schema if f.name not in set(floating)]
    parts: dict[str, list[NDArray[Any]]] = {name: [] for name in floating}
    rest = []
    for batch in batches:
        for name in floating:
            # A copy, so that the memory of the batch serves the next one.
            parts[name].append(batch[name].cast(pa.float64()).to_numpy(zero_copy_only=False).copy())
        rest.append(batch.select(others))
    left = pa.Table.from_batches(rest, schema=pa.schema([schema.field(name) for name in others]))
    table = table_from_arrow(left, source, notes)
    numbers: dict[str, NDArray[Any]] = {}
    for name in schema.names:  # in the order of the file
        if name in parts:
            numbers[name] = np.concatenate([np.zeros(0), *parts.pop(name)])
        elif name in table.columns:
            numbers[name] = table.columns[name]
    pa.default_memory_pool().release_unused()  # it keeps what it has held, more than the numbers of a long log
    return replace(table, columns=numbers)
