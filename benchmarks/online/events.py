"""What a monitor says, as far as it is measured: any objects that have these."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol


class Named(Protocol):
    """A term, of which only the label counts: ``effect@joint``."""

    @property
    def label(self) -> str:
        """Name and place."""
        ...


class Event(Protocol):
    """What a monitor reports; see the package's `Event`."""

    @property
    def time(self) -> float:
        """When [s]."""
        ...

    @property
    def stage(self) -> str:
        """``detection``, ``isolation``, ``accommodation`` or ``idle``."""
        ...

    @property
    def joints(self) -> tuple[str, ...]:
        """Joints concerned."""
        ...

    @property
    def verdict(self) -> str:
        """``unique``, ``ambiguous``, ``unknown`` or ``none``."""
        ...

    @property
    def faults(self) -> Sequence[Named]:
        """What it is; of several equal combinations the likeliest."""
        ...

    @property
    def alternatives(self) -> Sequence[Sequence[Named]]:
        """Other combinations that explain the same."""
        ...
