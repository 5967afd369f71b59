"""Short phrases for messages and reprs: long lists and long names are cut."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import fields
from typing import Any

LONGEST_NAME = 80  # characters of a name that are shown in a list
LONGEST_REASON = 160  # characters of a library's own message that are shown
NO_BREAK = "\N{NO-BREAK SPACE}"


def plural(noun: str, count: int) -> str:
    """Return a noun in the singular or the plural.

    Args:
        noun: In the singular; its plural ends in s.
        count: How many there are.
    """
    return noun if count == 1 else f"{noun}s"


def counted(count: int, noun: str) -> str:
    """Return a count with its noun, such as ``1 gap`` or ``3 gaps``.

    Args:
        count: How many there are.
        noun: In the singular; its plural ends in s.
    """
    return f"{count} {plural(noun, count)}"


def numbered(name: str, taken: Collection[str]) -> str:
    """Return a name, with the first number from 2 on that makes it another one than those that are taken.

    Args:
        name: The name.
        taken: Names that are taken.
    """
    free, count = name, 1
    while free in taken:
        count += 1
        free = f"{name} ({count})"
    return free


def some(names: Sequence[str], most: int = 12) -> str:
    """Return names separated by commas; a long list is cut and its length is stated.

    Args:
        names: The names, in the order in which they are shown.
        most: Largest number of names that are shown.

    Returns:
        One line, such as ``a, b, … (14 in all)``.
    """
    shown = [name if len(name) <= LONGEST_NAME else clipped(name, LONGEST_NAME) for name in names[:most]]
    return ", ".join(shown) + (f", … ({len(names)} in all)" if len(names) > most else "")


def shortened(text: str, most: int = 40) -> str:
    """Return a text in quotes, on one line, cut in the middle where it is long.

    Args:
        text: A name, such as that of a file.
        most: Largest number of characters of the text that are shown.

    Returns:
        The text in single quotes.
    """
    return f"'{clipped(text, most)}'"


def printable(text: str, also: str = "") -> str:
    """Return a text without characters that control a terminal or turn its direction around.

    Args:
        text: Any text, such as a name from a file.
        also: More characters that are kept, such as the end of a line.

    Returns:
        The text with a replacement character for each of them.
    """
    if text.isprintable():
        return text
    keep = {*also, NO_BREAK}
    return "".join(c if c.isprintable() or c in keep else "\N{REPLACEMENT CHARACTER}" for c in text)


def one_line(error: BaseException, most: int | None = None) -> str:
    """Return an error's message as one line; its kind, if it has none.

    Args:
        error: Any exception.
        most: Largest number of characters; no limit if None.
    """
    return " ".join(str(error).split())[:most] or type(error).__name__


def clipped(text: str, most: int = 40) -> str:
    """Return a text on one line, cut in the middle where it is long.

    Args:
        text: The text.
        most: Largest number of characters that are shown.
    """
    line = " ".join(text.split())
    if len(line) <= most:
        return line
    head = most // 2
    return f"{line[:head]}…{line[len(line) - (most - head - 1) :]}"


def changed_fields(settings: Any) -> str:
    """Return ``name=value`` of the fields that differ from their defaults, for a short ``repr``.

    Args:
        settings: A dataclass whose fields all have defaults.
    """
    usual = type(settings)()
    pairs = ((f.name, getattr(settings, f.name), getattr(usual, f.name)) for f in fields(settings))
    return ", ".join(f"{name}={value!r}" for name, value, default in pairs if value != default)


def settings_repr(settings: Any) -> str:
    """Return a ``repr`` of at most 190 characters that shows the fields that differ from their defaults.

    Args:
        settings: A dataclass whose fields all have defaults.
    """
    return f"{type(settings).__name__}({clipped(changed_fields(settings), 150)})"
