"""Cells of tables for the terminal: plain texts, never markup."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from cdia_pin.phrases import printable
from cdia_pin.viewers.whole_table import WholeTable
from cdia_pin.viewers.whole_words import WholeWords


def new_table(*heads: str, left: Sequence[int]) -> WholeTable:
    """Return an empty table.

    Args:
        *heads: Headings of the columns.
        left: Columns that hold text and may wrap; the others hold numbers.
    """
    table = WholeTable()
    for k, head in enumerate(heads):
        text = k in left
        table.add_column(clean(head), justify="left" if text else "right", no_wrap=not text, vertical="top")
    return table


def add_row(table: Table, *cells: str, style: str = "") -> None:
    """Add a row of texts.

    Args:
        table: Where.
        *cells: A text for each column.
        style: Of the row, as `rich` names it.
    """
    table.add_row(*(clean(c) for c in cells), style=style)


def table_of(heads: Sequence[str], rows: Sequence[Sequence[str]], left: tuple[int, ...]) -> WholeTable:
    """Return rows as a table.

    Args:
        heads: Headings.
        rows: Cells.
        left: Columns that are text.
    """
    table = new_table(*heads, left=left)
    for row in rows:
        add_row(table, *row)
    return table


def clean(text: str, style: str = "") -> WholeWords:
    """Return a text that is never read as markup, without characters that control a terminal; none of it is lost.

    Args:
        text: The text.
        style: As `rich` names it.
    """
    return WholeWords(printable(text, also="\n"), style)
