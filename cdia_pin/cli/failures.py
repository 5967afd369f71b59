"""Errors of the command line itself; those of the library pass through as they are."""

from __future__ import annotations

from cdia_pin.errors import CdiaError


class CommandError(CdiaError):
    """An option, or a file that a command is to write, is not what it must be."""


def one_line(error: BaseException) -> str:
    """Return an error's message as one line."""
    return " ".join(str(error).split()) or type(error).__name__
