"""How fast work goes, and how long the rest of it will take."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic

MINUTE, HOUR = 60.0, 3600.0  # [s]


class Pace:
    """Counts finished items from its making on.

    Args:
        total: Number of items; None if it is not known.
        clock: Returns the time [s].
    """

    def __init__(self, total: int | None, clock: Callable[[], float] = monotonic) -> None:
        self._total, self._clock, self._begin = total, clock, clock()
        self.done = 0

    def one_more(self) -> None:
        """Count one more finished item."""
        self.done += 1

    @property
    def share(self) -> float:
        """Share of the items that are finished [1]; 0 if their number is not known."""
        return self.done / self._total if self._total else 0.0

    @property
    def left(self) -> float | None:
        """Time that the rest takes at the mean rate so far [s]; None before the first item or without a total."""
        if self._total is None or not self.done:
            return None
        return (self._clock() - self._begin) / self.done * (self._total - self.done)

    def __str__(self) -> str:
        spent = max(self._clock() - self._begin, 1e-9)
        rate = self.done / spent
        speed = f"{rate:.3g} a second" if rate >= 1 else f"{rate * MINUTE:.3g} a minute"
        of = "" if self._total is None else f" of {self._total}"
        left = "" if self.left is None else f", {duration_words(self.left)} left"
        return f"{self.done}{of}, {speed}{left}"


def duration_words(seconds: float) -> str:
    """Return a duration in the unit that fits.

    Args:
        seconds: The duration [s].
    """
    if seconds < 2 * MINUTE:
        return f"{seconds:.0f} s"
    if seconds < 2 * HOUR:
        return f"{seconds / MINUTE:.0f} min"
    return f"{seconds / HOUR:.1f} h"
