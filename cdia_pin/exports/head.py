"""The first line of an exported file: what it is and where it is from."""

from __future__ import annotations

from cdia_pin.dynamics import Dynamics
from cdia_pin.phrases import printable
from cdia_pin.version import __version__


def head(model: Dynamics, what: str) -> str:
    """Return the line.

    Args:
        model: The model.
        what: What the file holds.
    """
    return printable(f"{what} of {model.robot.name}, written by cdia-pin {__version__}")
