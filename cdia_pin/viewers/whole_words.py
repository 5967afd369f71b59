"""Texts for the terminal that break at ordinary spaces only, so that a number keeps its unit, and lose no character."""

from __future__ import annotations

import re
from collections.abc import Iterator

from rich.cells import cell_len, chop_cells
from rich.console import Console, ConsoleOptions, JustifyMethod, OverflowMethod
from rich.containers import Lines
from rich.measure import Measurement
from rich.text import Text

from cdia_pin.phrases import NO_BREAK

JOINING = "_+@/"  # signs after which a long name is broken
WORD = re.compile(r" *[^ ]+ *| +")


class WholeWords(Text):
    """A text that is wrapped at ordinary spaces; a word that is wider than its column goes on in the next line."""

    def wrap(
        self,
        console: Console,
        width: int,
        *,
        justify: JustifyMethod | None = None,
        overflow: OverflowMethod | None = None,
        tab_size: int = 8,
        no_wrap: bool | None = None,
    ) -> Lines:
        """Return the lines of the text; `overflow` and `no_wrap` are not asked: nothing is ever cut.

        Args:
            console: Where it is printed.
            width: Width of a line [characters].
            justify: How lines are aligned.
            overflow: Not used.
            tab_size: Not used.
            no_wrap: Not used.
        """
        lines = Lines()
        for line in self.split(allow_blank=True):
            line.expand_tabs(tab_size)
            for part in line.divide(list(_breaks(line.plain, width))):
                part.plain = part.plain.replace(NO_BREAK, " ")
                part.rstrip()
                lines.append(part)
        if justify:
            lines.justify(console, width, justify=justify, overflow="fold")
        return lines

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        return Measurement(self.narrowest, self.widest)

    @property
    def narrowest(self) -> int:
        """Width of the longest word [characters]."""
        return max((cell_len(word) for word in re.split(r"[ \n]+", self.plain)), default=0)

    @property
    def widest(self) -> int:
        """Width of the longest line [characters]."""
        return max((cell_len(line) for line in self.plain.split("\n")), default=0)


def _breaks(line: str, width: int) -> Iterator[int]:
    """Yield where a line is broken."""
    used = 0
    for found in WORD.finditer(line):
        word = found.group()
        size = cell_len(word.rstrip(" "))
        if used and used + size > width:
            yield found.start()
            used = 0
        at, left = found.start(), word.rstrip(" ")
        while cell_len(left) > width > 0:
            taken = _head(left, width)
            at, left = at + taken, left[taken:]
            yield at
        used = (used if size <= width else 0) + cell_len(left) + len(word) - len(word.rstrip(" "))


def _head(word: str, width: int) -> int:
    """Return how many characters of a long word go in a line: up to a sign that joins names, else all that fit."""
    fits = max(len(chop_cells(word, width)[0]), 1)  # a wide character may be wider than the column
    joined = max(word.rfind(sign, 0, fits) for sign in JOINING) + 1
    return joined if joined > fits // 2 else fits
