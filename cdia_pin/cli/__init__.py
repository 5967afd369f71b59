"""The command ``cdia``: one file a command; it reads options, calls the library and shows what it returns."""

from cdia_pin.cli.program import main

__all__ = ["main"]
