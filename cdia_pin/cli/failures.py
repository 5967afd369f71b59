"""Errors of the command line itself; errors of the library pass through as they are."""

from __future__ import annotations

from cdia_pin.errors import CdiaError


class CommandError(CdiaError):
    """An option, or an output file of a command, cannot be used."""
