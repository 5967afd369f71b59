"""Long work in a thread, beside a page that stays alive: with progress, and cancelled at its next report."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

from cdia_pin.progress import Progress

T = TypeVar("T")


class Cancelled(Exception):  # noqa: N818  (nothing went wrong)
    """The work was cancelled."""


class Job(Generic[T]):
    """One piece of work in a thread of its own.

    After `cancel`, the thread ends at the next report of its progress; whoever waits is free at once.

    Args:
        work: Called with a function that takes its progress; returns the result.

    Attributes:
        said: What is being done.
        share: The share that is done, from 0 to 1; it never falls.
    """

    def __init__(self, work: Callable[[Progress], T]) -> None:
        self.said, self.share = "", 0.0
        self._work = work
        self._ended = threading.Event()
        self._cancelled = False
        self._result: T | None = None
        self._error: BaseException | None = None
        threading.Thread(target=self._run, name="cdia job", daemon=True).start()

    def cancel(self) -> None:
        """Drop the result."""
        self._cancelled = True
        self._ended.set()

    @property
    def ended(self) -> bool:
        """Whether there is a result or an error, or the work was cancelled."""
        return self._ended.is_set()

    @property
    def cancelled(self) -> bool:
        """Whether the work was cancelled."""
        return self._cancelled

    def result(self, timeout: float | None = None) -> T:
        """Wait for the result.

        Args:
            timeout: How long to wait [s]; None for ever.

        Raises:
            Cancelled: If the work was cancelled.
            TimeoutError: If it takes longer.
            Exception: What the work raised.
        """
        if not self._ended.wait(timeout):
            raise TimeoutError("the work has not ended yet")
        if self._cancelled:
            raise Cancelled
        if self._error is not None:
            raise self._error
        return self._result  # type: ignore[return-value]

    def _run(self) -> None:
        try:
            self._result = self._work(self._tell)
        except Cancelled:
            self._cancelled = True
        except BaseException as error:
            self._error = error
        self._ended.set()

    def _tell(self, sentence: str, share: float) -> None:
        if self._cancelled:
            raise Cancelled
        self.said, self.share = sentence, max(self.share, share)
