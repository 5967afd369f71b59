"""A table that loses no character however narrow the terminal is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from rich import box
from rich.console import Console, ConsoleOptions, RenderResult
from rich.measure import Measurement
from rich.style import StyleType
from rich.table import Column, Table
from rich.text import Text

from cdia_pin.viewers.whole_words import WholeWords

BESIDE = 2  # characters that each column takes beside its contents
LONG_WORD = 16  # characters; longer words of a text that wraps may be broken
NAMES_SHARE = 3  # long names in the first column wrap, rather than take more than this part of the width


class WholeTable(Table):
    """A table whose text columns wrap; where its columns are too many, the others follow below, beside the first.

    Cells and headings are `WholeWords`; other texts are made such.
    """

    def __init__(self, title: str | None = None) -> None:
        super().__init__(title=title, title_justify="left", header_style="bold", box=box.SIMPLE_HEAD)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the table, in parts where it is too wide."""
        for part in self._parts(options.max_width):
            yield self._part(part, options.max_width)
        if self.caption:
            caption = _whole(self.caption)
            caption.stylize("table.caption")
            yield caption

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        every = [self._widths(c) for c in self.columns]
        beside = BESIDE * len(every)
        widest = min(sum(most for _, most in every) + beside, options.max_width)
        return Measurement(min(sum(least for least, _ in every) + beside, widest), widest)

    def _parts(self, width: int) -> Iterator[list[int]]:
        """Yield the columns of each part, the first column in all of them."""
        needed = [self._widths(c)[0] + BESIDE for c in self.columns]
        needed[0] = min(needed[0], max(width // NAMES_SHARE, 1))
        part = [0]
        for k in range(1, len(needed)):
            if len(part) > 1 and sum(needed[p] for p in [*part, k]) > width:
                yield part
                part = [0]
            part.append(k)
        yield part

    def _part(self, part: Sequence[int], width: int) -> Table:
        """Return the columns of a part as a table of `rich`."""
        columns = [self.columns[k] for k in part]
        shown = Table(
            box=self.box,
            pad_edge=False,
            collapse_padding=True,
            header_style=self.header_style,
            title=self.title,
            title_justify=self.title_justify,
        )
        widths = self._shared(columns, width - BESIDE * len(part))
        for column, size in zip(columns, widths, strict=True):
            shown.add_column(
                _whole(column.header), justify=column.justify, style=column.style, width=size, vertical="top"
            )
        cells = [list(column.cells) for column in columns]
        for k, row in enumerate(self.rows):
            style: StyleType | None = row.style
            shown.add_row(*(_whole(column[k]) for column in cells), style=style, end_section=row.end_section)
        return shown

    def _shared(self, columns: Sequence[Column], room: int) -> list[int]:
        """Return the width of each column: its widest if there is room, else headings and long texts wrap."""
        least, out = ([w[k] for w in map(self._widths, columns)] for k in (0, 1))
        numbers = [k for k, c in enumerate(columns) if c.no_wrap]
        for k in sorted(numbers, key=lambda k: least[k] - out[k]):  # the longest heading wraps first
            if sum(out) > room:
                out[k] = least[k]
        while sum(out) > max(room, len(out)):
            able = [k for k, size in enumerate(out) if size > least[k]] or [
                0 if out[0] > 1 else int(np.argmax(out))
            ]
            out[max(able, key=lambda k: out[k])] -= 1
        return out

    def _widths(self, column: Column) -> tuple[int, int]:
        """Return the narrowest and the widest a column can sensibly be [characters]; any heading may wrap."""
        head, cells = _whole(column.header), [_whole(t) for t in column.cells]
        narrow = [t.widest if column.no_wrap else min(t.narrowest, LONG_WORD) for t in cells]
        return max([head.narrowest, *narrow]), max(t.widest for t in (head, *cells))


def _whole(text: object) -> WholeWords:
    """Return a text that loses nothing."""
    if isinstance(text, WholeWords):
        return text
    out = WholeWords()
    out.append_text(text if isinstance(text, Text) else Text.from_markup(str(text)))
    return out
