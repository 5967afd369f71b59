"""Linear algebra on one thread."""

import pytest

from cdia_pin import Dynamics, discover, identify, logs_dir, read_log
from cdia_pin.threads import on_one_thread


def threads() -> set[int]:
    from threadpoolctl import threadpool_info

    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def several():
    from threadpoolctl import threadpool_limits

    return threadpool_limits(limits=2, user_api="blas")


@on_one_thread
def during(fails: bool = False) -> set[int]:
    """Threads while it runs."""
    if fails:
        raise ValueError("it fails")
    return threads()


def test_work_has_one_thread_and_the_process_its_own_again():
    with several():
        before = threads()
        assert during() == {1}
        assert threads() == before


def test_an_error_leaves_the_threads_as_they_were():
    with several():
        before = threads()
        with pytest.raises(ValueError, match="it fails"):
            during(fails=True)
        assert threads() == before


@pytest.mark.parametrize("work", [discover, identify])
def test_a_program_that_asks_for_nothing_gets_one_thread(ur5, work):
    log = read_log(logs_dir() / "demo_ur5.csv", ur5)
    seen = []

    def stopped(sentence: str, share: float) -> None:
        seen.append(threads())
        raise InterruptedError

    with several(), pytest.raises(InterruptedError):
        work(Dynamics(ur5), log, progress=stopped)
    assert seen == [{1}]
