"""Work for the tests of the engine: functions that workers can import."""

import os
import signal
import time


def slowly(item: int) -> tuple[int, int]:
    time.sleep(0.05)
    return item, os.getpid()


def refuse_three(item: int) -> int:
    if item == 3:
        raise ValueError("no three")
    return item


def end_the_worker_at_two(item: int) -> int:
    if item == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return item


def number_of_threads(item: int) -> str:
    return os.environ["OPENBLAS_NUM_THREADS"]


def samples_itself(item: int) -> bool:
    import dask

    return bool(dask.config.get("distributed.worker.profile.enabled"))
