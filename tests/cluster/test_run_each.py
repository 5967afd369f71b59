"""Every item is given once, whatever happens to the process that works on it."""

import os
import re
import signal
import subprocess
import time
from itertools import count, islice
from pathlib import Path

import pytest

from cdia_pin.cluster import ClusterError, number_of_workers, run_each
from cdia_pin.cluster.pace import Pace, duration_words
from tests import cluster_work as work
from tests.processes import dask, python, worker


@pytest.mark.parametrize("workers", [1, 2])
def test_each_item_is_given_once_with_its_result_or_its_error(workers):
    told: list[tuple[str, float]] = []
    results = list(
        run_each(work.refuse_three, range(6), workers=workers, progress=lambda *said: told.append(said))
    )
    assert sorted(f.item for f in results) == list(range(6))
    assert {f.item: f.why for f in results if f.error} == {3: "ValueError: no three"}
    assert all(f.result == f.item for f in results if not f.error)
    assert [share for _, share in told] == pytest.approx([k / 6 for k in range(1, 7)])
    assert told[-1][0].startswith("6 of 6, ")


def test_a_killed_worker_loses_nothing_and_gives_nothing_twice(scheduler):
    with worker(scheduler) as first, worker(scheduler) as second:
        running = run_each(work.slowly, range(60), scheduler=scheduler)
        given = list(islice(running, 12))
        while {f.result[1] for f in given} != {first.pid, second.pid}:  # both are at work
            given.append(next(running))
        os.kill(first.pid, signal.SIGKILL)
        given += running
    assert sorted(f.result[0] for f in given) == list(range(60))
    assert {f.result[1] for f in given[-20:]} == {second.pid}


def test_no_process_is_started_that_would_have_no_item():
    assert number_of_workers(None, None, 1) == number_of_workers(None, None, 0) == 1
    assert number_of_workers(3, None, 1) == 3  # as asked
    (only,) = run_each(work.slowly, [7])
    assert only.result == (7, os.getpid())


def test_an_item_that_ends_its_workers_is_the_only_one_that_fails():
    results = list(run_each(work.end_the_worker_at_two, range(5), workers=2))
    assert sorted(f.item for f in results) == list(range(5))
    assert [(f.item, type(f.error)) for f in results if f.error] == [(2, ClusterError)]


def test_a_lost_scheduler_is_an_error_and_not_an_endless_wait():
    with dask("scheduler", "--port", "0", "--no-dashboard") as process:
        address = next(m[0] for line in process.stderr if (m := re.search(r"tcp://127\.0\.0\.1:\d+", line)))
        with worker(address):
            running = run_each(work.slowly, range(1000), scheduler=address)
            next(running)
            process.kill()
            with pytest.raises(ClusterError, match="was lost"):
                list(running)


def test_items_are_taken_as_workers_get_free(scheduler):
    taken: list[int] = []
    with worker(scheduler):
        running = run_each(work.slowly, (taken.append(k) or k for k in count()), scheduler=scheduler)
        assert len(list(islice(running, 5))) == 5
        running.close()
    assert len(taken) < 20


def test_workers_do_not_sample_themselves():
    assert [done.result for done in run_each(work.samples_itself, range(2), workers=2)] == [False, False]


def test_workers_have_one_thread_and_listen_on_the_loopback_alone():
    import psutil  # which Dask brings

    here = psutil.Process()
    others = set(here.children(recursive=True))
    running = run_each(work.number_of_threads, range(4), workers=2)
    assert next(running).result == "1"
    processes = {here, *here.children(recursive=True)} - others
    assert len(processes) > 2
    heard = {c.laddr.ip for p in processes for c in p.net_connections() if c.status == "LISTEN"}
    assert heard == {"127.0.0.1"}
    running.close()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"workers": 0}, "at least one worker"),
        ({"workers": 2, "scheduler": "tcp://127.0.0.1:1"}, "leave their number out"),
        ({"scheduler": "somewhere"}, "the scheduler somewhere cannot be reached"),
    ],
)
def test_what_cannot_be_is_said_in_one_line(options, said):
    with pytest.raises(ClusterError, match=said) as caught:
        list(run_each(work.slowly, [1], **options))
    assert "\n" not in str(caught.value)


def test_the_pace_says_rate_and_time_left():
    now = 0.0
    pace = Pace(100, clock=lambda: now)
    assert str(pace) == "0 of 100, 0 a minute"
    for _ in range(10):
        pace.one_more()
    now = 20.0
    assert pace.share == 0.1
    assert str(pace) == "10 of 100, 30 a minute, 3 min left"
    assert str(Pace(None, clock=lambda: now)) == "0, 0 a minute"
    assert [duration_words(s) for s in (5, 600, 36000, 864000)] == ["5 s", "10 min", "10.0 h", "10.0 days"]


def test_ctrl_c_ends_the_work_and_its_processes(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "from cdia_pin.cluster import run_each\n"
        "from tests import cluster_work as work\n"
        "if __name__ == '__main__':\n"
        "    for one in run_each(work.slowly, range(100000), workers=2):\n"
        "        print(one.item, flush=True)\n"
    )
    process = subprocess.Popen(
        python(str(script)),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env={**os.environ, "PYTHONPATH": str(Path.cwd())},
    )
    for _ in range(5):
        process.stdout.readline()
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: all processes get it
    begin = time.monotonic()
    _, said = process.communicate(timeout=20)
    assert process.returncode != 0
    assert said.endswith("KeyboardInterrupt\n")
    assert "Dask Worker process" not in said  # workers end in silence
    assert time.monotonic() - begin < 10
    while alive_in(process.pid) and time.monotonic() - begin < 15:
        time.sleep(0.05)
    assert not alive_in(process.pid)


def alive_in(group: int) -> list[int]:
    import psutil

    return [
        p.pid
        for p in psutil.process_iter()
        if p.status() != psutil.STATUS_ZOMBIE and os.getpgid(p.pid) == group
    ]
