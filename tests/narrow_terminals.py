"""What a table must keep in a terminal of any width."""

import io
from collections import Counter

from rich.cells import cell_len
from rich.console import Console

WIDE, NARROW = 2000, (200, 80, 60)  # characters
RULES = set("─ \n")


def printed(table, width: int) -> str:
    console = Console(file=io.StringIO(), width=width, color_system=None)
    console.print(table)
    text = console.file.getvalue()
    assert max(map(cell_len, text.splitlines())) <= width
    return text


def characters(text: str) -> Counter:
    return Counter(c for c in text if c not in RULES)


def loses_nothing(table) -> None:
    """No character of the table as it is without a limit is missing where it is narrow."""
    whole = characters(printed(table, WIDE))
    for width in NARROW:
        narrow = characters(printed(table, width))
        assert not whole - narrow
        assert narrow["…"] == whole["…"]  # the sign of what was cut
