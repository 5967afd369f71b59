"""Long work beside a page that stays alive: in a thread, with its progress, and cancelled at the next word."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

from cdia_pin.progress import Progress

T = TypeVar("T")


class Cancelled(Exception):  # noqa: N818  (nothing went wrong)
    """The work is no longer wanted."""


class Job(Generic[T]):
    """One piece of work in a thread of its own.

    Its thread ends by itself at the next word of its progress after `cancel`; whoever waits is free at once.

    Args:
        work: Given a function that it tells its progress; returns the result.

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
        """Say that the result is no longer wanted."""
        self._cancelled = True
        self._ended.set()

    @property
    def ended(self) -> bool:
        """Whether there is a result, an error or nobody who wants one."""
        return self._ended.is_set()

    @property
    def cancelled(self) -> bool:
        """Whether nobody wants the result."""
        return self._cancelled

    def result(self, timeout: float | None = None) -> T:
        """Wait for the result.

        Raises:
            Cancelled: If it was cancelled.
            TimeoutError: If it takes longer than `timeout` [s].
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
