"""Processes that tests start and interrupt."""

import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

HEEDING = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.SIG_DFL)
os.execv(sys.executable, [sys.executable, *sys.argv[1:]])
"""


def python(*arguments: str) -> list[str]:
    """Return a command that heeds Ctrl-C: shells have what runs in the background, such as these tests, ignore it."""
    return [sys.executable, "-c", HEEDING, *arguments]


@contextmanager
def dask(kind: str, *options: str) -> Iterator[subprocess.Popen[str]]:
    """Start a ``scheduler`` or a ``worker`` of Dask, and kill it in the end."""
    command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", "--host", "127.0.0.1", *options]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


@contextmanager
def worker(scheduler: str) -> Iterator[subprocess.Popen[str]]:
    """Start a worker with one thread."""
    with dask("worker", scheduler, "--nthreads", "1", "--no-nanny", "--no-dashboard") as process:
        threading.Thread(target=process.stderr.read, daemon=True).start()  # a full pipe would stop it
        yield process
