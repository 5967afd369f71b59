"""`Stateful`: what a part of a monitor states about itself, so that it can be stored and restored in mid-run."""

from __future__ import annotations

from typing import Any, ClassVar


class Stateful:
    """A part whose ticks leave something behind.

    Every attribute that is changed after the constructor stands in one of two lists. All others stay as the constructor
    made them, from what is known of the healthy arm.

    Attributes:
        STATE: Names of the attributes that are stored: values, or further parts.
        DERIVED: Names of the attributes that follow from those, or are filled before each use.
    """

    STATE: ClassVar[tuple[str, ...]] = ()
    DERIVED: ClassVar[tuple[str, ...]] = ()

    def take(self, name: str, value: Any) -> None:
        """Take one stored value.

        Args:
            name: Name of the attribute, one of `STATE`.
            value: Its value.
        """
        setattr(self, name, value)

    def new_part(self, name: str) -> Stateful:
        """Make a part that was stored under a name, where there is none at the start.

        Args:
            name: Name of the attribute, one of `STATE`.

        Raises:
            KeyError: If the attribute holds no such parts.
        """
        raise KeyError(name)

    def restored(self) -> None:
        """Work out what follows from the state, after all of it was taken."""
