"""A solver that may fail: it gives up in silence instead of ending the program or filling the terminal."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from clarabel import DefaultSolver

Array = NDArray[np.float64]

STANDARD_ERROR = 2  # file descriptor
GOOD = {"Solved", "AlmostSolved"}

_redirected = Lock()  # two threads at once would leave the terminal silent


def solved(build: Callable[[], DefaultSolver]) -> Array | None:
    """Return the solver's numbers; None if it refused the problem, found none, or panicked.

    Args:
        build: Returns a solver with its problem.
    """
    try:
        with _silence():
            solution = build().solve()
    except Exception:
        return None
    except BaseException as panic:  # what Rust calls a panic is no Exception
        if type(panic).__name__ != "PanicException":
            raise
        return None
    if str(solution.status) not in GOOD:
        return None
    numbers = np.array(solution.x)
    return numbers if np.isfinite(numbers).all() else None


@contextmanager
def _silence() -> Iterator[None]:
    """Drop what is written to standard error, because a panic prints itself before Python can catch it."""
    with _redirected:
        try:
            sys.stderr.flush()
            terminal = os.dup(STANDARD_ERROR)
            nowhere = os.open(os.devnull, os.O_WRONLY)
        except (OSError, AttributeError, ValueError):  # a program without a terminal
            yield
            return
        try:
            os.dup2(nowhere, STANDARD_ERROR)
            yield
        finally:
            os.dup2(terminal, STANDARD_ERROR)
            os.close(terminal)
            os.close(nowhere)
