"""`run_each`: one function on many items, in this process, on the cores of this machine, or on a cluster."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sized
from typing import TypeVar

from cdia_pin.cluster.finished import ClusterError, Finished
from cdia_pin.cluster.pace import Pace
from cdia_pin.extras import require
from cdia_pin.progress import Progress, silent

I = TypeVar("I")  # noqa: E741
R = TypeVar("R")


def run_each(
    function: Callable[[I], R],
    items: Iterable[I],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = silent,
) -> Iterator[Finished[I, R]]:
    """Run a function on every item; give each result as it finishes, in no particular order.

    Each item is given once. If a worker is lost, its items run again on another one, so the function must leave no
    trace but its result: the caller keeps what is to be kept. Items are taken from `items` only as workers get free,
    so there may be any number of them. The work stops when the caller stops to iterate, or is interrupted; what was
    given until then is complete.

    One worker without a scheduler is this process itself. Several are processes with one thread each, which listen on
    the loopback interface alone. They import the main module, so a script needs ``if __name__ == "__main__":``.

    Args:
        function: A function of a module that the workers can import.
        items: What it is called with; values that can be pickled.
        workers: Number of processes on this machine; one a core if omitted, and none that would have no item.
        scheduler: Address of a running scheduler of Dask, such as ``tcp://10.0.0.7:8786``; its workers do the work.
        progress: Called after each item with the rate, the time left, and the share that is done [1].

    Yields:
        Each item with its result or its error. An error of one item does not end the others.

    Raises:
        ClusterError: If the scheduler cannot be reached or is lost, its workers have another version of the package,
            or the number of workers is given together with a scheduler or is below 1.
        MissingExtraError: If there are several workers and the extra ``fleet`` is not installed.
    """
    count = number_of_workers(workers, scheduler, len(items) if isinstance(items, Sized) else None)
    if count == 1:
        results = run_here(function, items)
    else:
        from cdia_pin.cluster.distributed_run import run_on_workers

        results = run_on_workers(function, items, count, scheduler)
    return _told(results, Pace(len(items) if isinstance(items, Sized) else None), progress)


def number_of_workers(workers: int | None, scheduler: str | None, items: int | None = None) -> int:
    """Return how many processes of this machine are asked for; 0 if the workers are those of a scheduler.

    Args:
        workers: Number of processes; one a core if None.
        scheduler: Address of a running scheduler, or None.
        items: Number of items, above which no process is started unless it is asked for; None if it is not known.

    Raises:
        ClusterError: If both are given, or the number is below 1.
        MissingExtraError: If there are several workers and the extra ``fleet`` is not installed.
    """
    if scheduler is not None and workers is not None:
        raise ClusterError(f"the scheduler {scheduler} has its own workers: leave their number out")
    if workers is not None and workers < 1:
        raise ClusterError(f"there must be at least one worker, given {workers}")
    most = usable_cores() if items is None else min(usable_cores(), max(items, 1))
    count = 0 if scheduler is not None else workers or most
    if count != 1:
        require("fleet", "several workers")
    return count


def usable_cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def run_here(function: Callable[[I], R], items: Iterable[I]) -> Iterator[Finished[I, R]]:
    """Run a function on every item in this process, one after the other.

    Args:
        function: The function.
        items: What it is called with.
    """
    for item in items:
        try:
            value = function(item)
        except Exception as error:
            yield Finished(item, None, error)
        else:
            yield Finished(item, value)


def _told(results: Iterator[Finished[I, R]], pace: Pace, progress: Progress) -> Iterator[Finished[I, R]]:
    for one in results:
        pace.one_more()
        progress(str(pace), pace.share)
        yield one
