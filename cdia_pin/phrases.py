"""Short phrases for messages and reprs: long lists and long names are cut."""

from __future__ import annotations

from collections.abc import Sequence


def some(names: Sequence[str], most: int = 12) -> str:
    """Return names separated by commas; a long list is cut and its length is stated.

    Args:
        names: The names, in the order in which they are shown.
        most: Largest number of names that are shown.

    Returns:
        One line, such as ``a, b, … (14 in all)``.
    """
    return ", ".join(names[:most]) + (f", … ({len(names)} in all)" if len(names) > most else "")


def shortened(text: str, most: int = 40) -> str:
    """Return a text in quotes, on one line, cut in the middle where it is long.

    Args:
        text: A name, such as that of a file.
        most: Largest number of characters of the text that are shown.

    Returns:
        The text in single quotes.
    """
    line = " ".join(text.split())
    if len(line) > most:
        head = most // 2
        line = f"{line[:head]}…{line[len(line) - (most - head - 1) :]}"
    return f"'{line}'"
