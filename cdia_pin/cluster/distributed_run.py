"""One function on many items, on workers of Dask, with few of the items on their way at any time."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import count, islice
from time import monotonic
from typing import Any, Generic, TypeVar
from uuid import uuid4

from cdia_pin.cluster.connection import connected
from cdia_pin.cluster.finished import ClusterError, Finished
from cdia_pin.phrases import one_line
from cdia_pin.version import __version__

I = TypeVar("I")  # noqa: E741
R = TypeVar("R")

AHEAD = (
    3  # items per thread that are submitted: one that runs, and two for the time until the next ones arrive
)
COUNT_EVERY = 2.0  # [s] between two looks at how many threads there are: workers come and go
SUSPECT = "killed"  # status of an item that was on a worker each time one was lost


def run_on_workers(
    function: Callable[[I], R], items: Iterable[I], workers: int, scheduler: str | None
) -> Iterator[Finished[I, R]]:
    """Run a function on every item on workers of Dask.

    Args:
        function: A function of a module that the workers can import.
        items: What it is called with.
        workers: Number of processes to start, if there is no scheduler.
        scheduler: Address of a running one.

    Yields:
        Each item with its result or its error.

    Raises:
        ClusterError: If the scheduler cannot be reached or is lost, or its workers cannot do the work.
    """
    with connected(workers, scheduler) as client:
        backlog = Backlog(client, function, scheduler or "on this machine")
        suspects: list[I] = []
        yield from backlog.run(iter(items), suspects)
        # Dask blames a lost worker on all items that it held. Alone, an item can only be blamed for itself.
        for item in suspects:
            guilty: list[I] = []
            yield from backlog.run(iter([item]), guilty)
            for one in guilty:
                yield Finished(one, None, ClusterError("every worker that ran it was lost"))


class Backlog(Generic[I, R]):
    """Items that have been submitted and not yet given.

    Args:
        client: A `distributed.Client`.
        function: What runs.
        where: Where the workers are, for messages.
    """

    def __init__(self, client: Any, function: Callable[[I], R], where: str) -> None:
        self._client, self._function, self._where = client, function, where
        self._name = f"{getattr(function, '__name__', 'run')}-{uuid4().hex}"
        self._numbers = count()
        self._threads, self._counted = 1, -float("inf")

    def run(self, items: Iterator[I], suspects: list[I]) -> Iterator[Finished[I, R]]:
        """Submit items as others finish.

        Args:
            items: What the function is called with.
            suspects: Takes the items that were on a worker each time one was lost.

        Yields:
            Each item with its result or its error.
        """
        from distributed import as_completed

        running: dict[Any, I] = {}
        done = as_completed([], loop=self._client.loop)
        try:
            while True:
                for item in islice(items, max(AHEAD * self._thread_count() - len(running), 0)):
                    future = self._submit(item)
                    running[future] = item
                    done.add(future)
                if not running:
                    return
                for future, reply in self._replies(done.next_batch()):
                    item = running.pop(future)
                    if reply is None:
                        suspects.append(item)
                    else:
                        yield Finished(item, reply.value, reply.error)
        finally:
            self._forget(list(running))

    def _thread_count(self) -> int:
        if monotonic() - self._counted > COUNT_EVERY:
            self._counted = monotonic()
            self._threads = max(sum(self._asked(self._client.nthreads).values()), 1)
        return self._threads

    def _submit(self, item: I) -> Any:
        key = f"{self._name}-{next(self._numbers)}"
        return self._asked(self._client.submit, answer, self._function, item, __version__, key=key)

    def _replies(self, futures: list[Any]) -> list[tuple[Any, Reply | None]]:
        """Return the reply of each future; None where a lost worker is blamed on it."""
        from distributed import KilledWorker

        given: list[tuple[Any, Reply | None]] = []
        for future in futures:
            if future.status == "error":
                error = self._asked(future.exception)
                if not isinstance(error, KilledWorker):
                    raise ClusterError(f"the workers {self._where} cannot do the work: {one_line(error)}")
                given.append((future, None))
            elif future.status == "cancelled":
                raise ClusterError(f"the scheduler {self._where} was lost")
        finished = [f for f in futures if f.status not in {"error", "cancelled"}]
        replies = self._asked(self._client.gather, finished)
        for reply in replies:
            if reply.version != __version__:
                raise ClusterError(
                    f"the workers {self._where} have cdia-pin {reply.version}, and here is {__version__}"
                )
        return given + list(zip(finished, replies, strict=True))

    def _asked(self, call: Callable[..., Any], *arguments: Any, **named: Any) -> Any:
        """Return the scheduler's answer to a call of the client."""
        from asyncio import CancelledError

        try:
            return call(*arguments, **named)
        except (OSError, CancelledError, TimeoutError) as error:
            raise ClusterError(f"the scheduler {self._where} was lost: {one_line(error)}") from None

    def _forget(self, futures: list[Any]) -> None:
        """Take back what has been submitted and is not wanted any more."""
        if futures and self._client.status == "running":
            self._client.cancel(futures, asynchronous=False)


@dataclass(frozen=True)
class Reply:
    """What a worker sends back.

    Attributes:
        value: Result of the function.
        error: What it raised.
        version: Version of the worker's package.
    """

    value: Any
    error: Exception | None
    version: str


def answer(function: Callable[[I], R], item: I, version: str) -> Reply:
    """Run on a worker: call the function and return its result or its error.

    Args:
        function: The function.
        item: What it is called with.
        version: Version of the caller's package; with another one the function is not called.
    """
    if version != __version__:
        return Reply(None, None, __version__)
    try:
        return Reply(function(item), None, __version__)
    except Exception as error:
        return Reply(None, sendable(error), __version__)


def sendable(error: Exception) -> Exception:
    """Return an error that arrives as it was sent, or its message where it cannot be pickled.

    Args:
        error: What a function raised.
    """
    try:
        if type(pickle.loads(pickle.dumps(error))) is type(error):
            return error
    except Exception:  # any class may refuse, in any way
        pass
    return RuntimeError(f"{type(error).__name__}: {one_line(error)}")
