"""Columns of numbers from batches of Arrow rows: memory for the numbers, and for one batch."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.logs.readers.arrow import table_from_arrow
from cdia_pin.logs.readers.table import Table

if TYPE_CHECKING:
    import pyarrow as pa

ROWS = 2**16  # rows of a batch [1]: some ten MB


def table_from_batches(
    batches: Iterable[pa.RecordBatch],
    schema: pa.Schema,
    source: str,
    notes: tuple[str, ...] = (),
    rows: int | None = None,
) -> Table:
    """Convert batches of rows as `table_from_arrow` converts a table.

    Floating-point numbers are taken over batch by batch. The few other columns are converted at the end, because
    their meaning may depend on all of their values.

    Args:
        batches: Batches of rows.
        schema: Names and types of the columns.
        source: Name of the file, for messages.
        notes: Notes of the reader, which are kept.
        rows: Number of rows, where the file states it: then the columns of one signal are side by side from the
            beginning, and `Table.stack` needs no copy of them.

    Raises:
        LogError: If two columns have the same name, or the file does not have the rows that it states.
    """
    import pyarrow as pa

    table_from_arrow(schema.empty_table(), source)  # refuses repeated names before anything is read
    floating = [f.name for f in schema if pa.types.is_floating(f.type)]
    others = [f.name for f in schema if f.name not in set(floating)]
    stated = {} if rows is None else _side_by_side(floating, rows)
    parts: dict[str, list[NDArray[Any]]] = {name: [] for name in floating if name not in stated}
    rest, count = [], 0
    for batch in batches:
        if rows is not None and count + len(batch) > rows:
            raise LogError(f"{source}: more than the {rows} rows that it states")
        for name in floating:
            numbers = batch[name].cast(pa.float64()).to_numpy(zero_copy_only=False)
            if name in stated:
                stated[name][count : count + len(batch)] = numbers
            else:
                parts[name].append(numbers.copy())  # so that the memory of the batch serves the next one
        rest.append(batch.select(others))
        count += len(batch)
    if rows is not None and count != rows:
        raise LogError(f"{source}: {count} rows, it states {rows}")
    left = pa.Table.from_batches(rest, schema=pa.schema([schema.field(name) for name in others]))
    table = table_from_arrow(left, source, notes)
    columns: dict[str, NDArray[Any]] = {}
    for name in schema.names:  # in the order of the file
        if name in stated:
            columns[name] = stated[name]
        elif name in parts:
            columns[name] = np.concatenate([np.zeros(0), *parts.pop(name)])
        elif name in table.columns:
            columns[name] = table.columns[name]
    pa.default_memory_pool().release_unused()  # it keeps what it has held, more than the numbers of a long log
    return replace(table, columns=columns)


def _side_by_side(names: list[str], rows: int) -> dict[str, NDArray[np.float64]]:
    """Return an empty column per name; those of one signal, such as ``position.*``, are of one array."""
    signals: dict[str, list[str]] = {}
    for name in names:
        signals.setdefault(name.partition(".")[0], []).append(name)
    columns = {}
    for of_signal in signals.values():
        whole = np.empty((rows, len(of_signal)))
        columns.update({name: whole[:, k] for k, name in enumerate(of_signal)})
    return columns
