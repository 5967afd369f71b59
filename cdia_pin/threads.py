"""One thread for linear algebra: the matrices are small, and threads that wait for each other only cost."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

Given = ParamSpec("Given")
Answer = TypeVar("Answer")


def on_one_thread(work: Callable[Given, Answer]) -> Callable[Given, Answer]:
    """Return a function whose linear algebra runs on one thread; the setting of the process comes back at its end.

    NumPy's and SciPy's libraries start a thread for each core. With matrices of a hundred rows they take two to four
    times the processor time, and on a busy machine the answer comes three times as late.

    Args:
        work: The function.
    """

    @wraps(work)
    def alone(*args: Given.args, **named: Given.kwargs) -> Answer:
        from threadpoolctl import threadpool_limits

        with threadpool_limits(limits=1, user_api="blas"):
            return work(*args, **named)

    return alone
