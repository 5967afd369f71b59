"""Readers: each turns one file format into a ``Table``."""

from cdia_pin.logs.readers.table import Table

__all__ = ["Table"]
