"""The sessions of the app: each has a key in its address, and waits a while for a page that has gone."""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

KEPT = 30 * 60.0  # [s], for which a session without a page is kept
MOST = 8  # sessions without a page; a log of usual length takes some 100 MB
KEY_BYTES = 9  # of a key: keys do not meet by chance; the door keeps strangers out


class Closable(Protocol):
    """What can be put on a shelf."""

    def close(self) -> None:
        """Free what it holds."""


T = TypeVar("T", bound=Closable)


@dataclass
class _Place(Generic[T]):
    item: T
    pages: int = 0
    end: asyncio.TimerHandle | None = None


class Shelf(Generic[T]):
    """Keeps items by key as long as a page shows them, and for a while after.

    Args:
        make: Makes a new item.
        kept: For how long an item without a page is kept [s].
    """

    def __init__(self, make: Callable[[], T], kept: float = KEPT) -> None:
        self._make, self._kept = make, kept
        self._places: dict[str, _Place[T]] = {}

    def begin(self) -> str:
        """Put a new item on the shelf and return its key; it waits for its first page."""
        key = secrets.token_urlsafe(KEY_BYTES)
        self._places[key] = _Place(self._make())
        self._wait(key)
        return key

    def find(self, key: str) -> T | None:
        """Return an item; None if there is none of this key, or no longer.

        Args:
            key: Of `begin`.
        """
        place = self._places.get(key)
        return None if place is None else place.item

    def show(self, key: str) -> Callable[[], None]:
        """Note that a page shows an item.

        Args:
            key: Of `begin`.

        Returns:
            To be called once when the page has gone.
        """
        place = self._places[key]
        place.pages += 1
        if place.end is not None:
            place.end.cancel()
            place.end = None

        def leave() -> None:
            place.pages -= 1
            if place.pages == 0 and self._places.get(key) is place:
                self._wait(key)

        return leave

    def close(self) -> None:
        """Drop all items."""
        for key in list(self._places):
            self._drop(key)

    def _wait(self, key: str) -> None:
        """Drop an item after a while, and the one that has waited longest where too many wait."""
        place = self._places.pop(key)
        self._places[key] = place  # behind those that have waited longer
        place.end = asyncio.get_running_loop().call_later(self._kept, self._drop, key)
        waiting = [k for k, p in self._places.items() if p.pages == 0]
        for oldest in waiting[:-MOST]:
            self._drop(oldest)

    def _drop(self, key: str) -> None:
        place = self._places.pop(key, None)
        if place is not None:
            if place.end is not None:
                place.end.cancel()
            place.item.close()
