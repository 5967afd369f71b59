"""The command ``cdia``: one file per command, which reads options, calls the library and shows the result."""

from cdia_pin.cli.program import main

__all__ = ["main"]
