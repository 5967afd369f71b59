"""Errors of the command line itself; errors of the library pass through as they are."""

from __future__ import annotations

from cdia_pin.errors import CdiaError


class CommandError(CdiaError):
    """An option, or an output file of a command, cannot be used."""


def one_line(error: BaseException) -> str:
    """Return an error's message as one line.

    Args:
        error: Any exception.
    """
    return " ".join(str(error).split()) or type(error).__name__
