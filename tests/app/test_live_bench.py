"""What moves is kept on the server: a page that is loaded again finds its run, moving or ended."""

import asyncio
import time

import pytest

from cdia_pin.app.frame_history import KEPT, FrameHistory
from cdia_pin.app.live_bench import LiveBench
from cdia_pin.app.shelf import Shelf
from cdia_pin.app.visit import Visit

FAULT = "viscous_friction@joint2: coefficient=0.1"


@pytest.fixture
def bench():
    made = LiveBench()
    made.form |= {"robot": "double_pendulum", "faults": FAULT}
    yield made
    made.close()


def begun(bench):
    asyncio.run(bench.begin())
    assert bench.runner.wrong == ""
    return bench.run


def ended(run):
    deadline = time.monotonic() + 60.0
    while not run.ended:
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return True


def test_a_page_that_comes_later_is_shown_what_was(bench):
    run = begun(bench)
    (fault,) = run.source.faults
    bench.switch(fault)
    first = run.frames.reader()
    seen = first()
    while len(seen.get("time", [])) < 5:
        time.sleep(0.05)
        seen = {key: seen.get(key, []) + rows for key, rows in first().items()} or seen
    again = run.frames.reader()()
    assert again["time"][: len(seen["time"])] == seen["time"]
    assert fault in run.source.acting and bench.scene is not None and bench.form["faults"] == FAULT


def test_a_run_waits_when_its_last_page_has_gone(bench):
    run = begun(bench)
    bench.arrive()
    bench.arrive()  # the page is loaded again, before its old self is known to have gone
    bench.leave()
    assert not run.paused
    bench.leave()
    assert run.paused and bench.moves and "Paused" in bench.runner.said
    bench.arrive()
    bench.pause()
    assert not run.paused


def test_an_ended_run_is_still_there_and_its_failure_is_said_once(bench):
    run = begun(bench)
    bench.end()
    assert ended(run) and bench.run is run and not bench.moves and bench.joint
    run.error = "the simulation diverged"
    bench.look()
    assert bench.runner.wrong == "the simulation diverged"
    bench.runner.say("something else")
    bench.look()
    assert bench.runner.said == "something else"


def test_what_cannot_begin_leaves_what_moves(bench):
    run = begun(bench)
    bench.form["robot"] = "none.urdf"
    asyncio.run(bench.begin())
    assert "none.urdf" in bench.runner.wrong
    assert bench.run is run and bench.moves


def test_the_run_ends_with_its_session(bench):
    async def visited():
        shelf = Shelf(lambda: Visit(lambda: None), kept=0.05)
        key = shelf.begin()
        live = shelf.find(key).live
        live.form |= bench.form
        leave = shelf.show(key)
        await live.begin()
        await asyncio.sleep(0.1)
        assert shelf.find(key).live is live and live.moves
        leave()
        await asyncio.sleep(0.1)
        assert shelf.find(key) is None
        return live

    assert ended(asyncio.run(visited()).run)


def test_the_last_frames_are_kept_and_what_is_attached_with_them():
    history = FrameHistory()
    early = history.reader()
    history.add({"time": [0.0], "attached": [(0.0, "nothing")]})
    history.add({"time": [1.0], "attached": [(1.0, "a payload")]})
    assert early()["time"] == [0.0, 1.0] and early() == {}
    for k in range(2, KEPT + 3):
        history.add({"time": [float(k)]})
    late = history.reader()()
    assert late["time"] == [float(k) for k in range(3, KEPT + 3)]
    assert late["attached"] == [(1.0, "a payload")]
    assert early()["time"] == late["time"]
