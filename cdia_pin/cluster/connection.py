"""The connection to Dask's workers: those of this machine, started for the work, or those of a running scheduler."""

from __future__ import annotations

import logging
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import Any

from cdia_pin.cluster.finished import ClusterError
from cdia_pin.phrases import one_line

LOOPBACK = "127.0.0.1"
ENOUGH = 30.0  # [s], for a scheduler to answer and for its first worker to come
# Each worker has one thread, so the libraries that it calls may use no more.
THREADS = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)
LOCAL = {
    # Items that a lost worker held run again one by one, which tells the guilty one: see `run_on_workers`.
    "distributed.scheduler.allowed-failures": 0,
    "distributed.nanny.pre-spawn-environ": THREADS,
    # Results are small and leave a worker at once. What fills its memory is the work itself, which neither writing
    # results to disk nor waiting makes smaller; only a worker that is about to take all of the memory is ended.
    "distributed.worker.memory.target": False,
    "distributed.worker.memory.spill": False,
    "distributed.worker.memory.pause": False,
    # Samples of what a worker does, a hundred a second. Nobody reads them, and an item takes a tenth longer.
    "distributed.worker.profile.enabled": False,
}


@contextmanager
def without_interrupts() -> Iterator[None]:
    """Start threads and processes that never get Ctrl-C, which a terminal sends to all; this thread gets it afterwards.

    This process ends its workers. One that is interrupted itself prints where it was, and may be started anew.
    """
    if not hasattr(signal, "pthread_sigmask"):  # such as on Windows
        yield
        return
    resource_tracker.ensure_running()  # its start inside the block would let interrupts through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def connected(workers: int, scheduler: str | None) -> Iterator[Any]:
    """Give a client of Dask, and end its workers afterwards if they were started for it.

    Args:
        workers: Number of processes to start, if there is no scheduler.
        scheduler: Address of a running one.

    Yields:
        A `distributed.Client` with at least one worker.

    Raises:
        ClusterError: If the scheduler cannot be reached, or no worker comes.
    """
    import dask
    from distributed import Client, LocalCluster

    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # the result of an item says what failed
    if scheduler is None:
        with dask.config.set(LOCAL):
            with without_interrupts():
                started = LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    host=LOOPBACK,
                    dashboard_address=f"{LOOPBACK}:0",
                    silence_logs=logging.CRITICAL,
                )
            with started as cluster, Client(cluster, set_as_default=False) as client:
                yield client
        return
    try:
        client = Client(scheduler, timeout=ENOUGH, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise ClusterError(f"the scheduler {scheduler} cannot be reached: {one_line(error, 160)}") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=ENOUGH)
        except TimeoutError:
            raise ClusterError(f"the scheduler {scheduler} has no workers") from None
        yield client
