"""A scheduler of Dask in a process of its own."""

import re
import threading
from collections.abc import Iterator

import pytest

from tests.fleet.conftest import small_fleet
from tests.processes import dask

__all__ = ["scheduler", "small_fleet"]


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    """A scheduler of its own process; its workers are ended first."""
    with dask("scheduler", "--port", "0", "--no-dashboard") as process:
        lines = iter(process.stderr.readline, "")
        address = next(m[0] for line in lines if (m := re.search(r"tcp://127\.0\.0\.1:\d+", line)))
        threading.Thread(target=process.stderr.read, daemon=True).start()  # a full pipe would stop it
        yield address
