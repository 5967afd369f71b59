"""What the second page watches: faults switched while an arm moves, and a log as it would have been."""

import time
from itertools import islice

import numpy as np
import pytest

from cdia_pin import CdiaError, Log, write_log
from cdia_pin.app.live_run import FRAMES, LiveRun
from cdia_pin.app.live_sources import Source, replayed, simulated
from cdia_pin.diagnosis import Stage

FAULT = "viscous_friction@joint2: coefficient=0.1"


def quiet(sentence, share):
    pass


def arm(*faults, accommodate=True):
    return simulated("double_pendulum", faults or (FAULT,), accommodate, quiet)


@pytest.fixture(scope="module")
def watched():
    """A source whose fault came and went, with the stages of its joint: healthy, faulty, healthy again."""
    source = arm()
    stages = []
    for acting in (False, True, False):
        source.acting.update(source.faults) if acting else source.acting.clear()
        ticks = list(islice(source.ticks, 3000))
        stages.append([t.status.stages[1] for t in ticks])
    return source, stages


def test_a_switched_fault_is_named_corrected_and_gone_again(watched):
    source, (before, during, after) = watched
    assert set(before) <= {Stage.HEALTHY, Stage.SUSPECT}
    assert during[-1] == Stage.ACCOMMODATED
    named = [t.effect.name for e in source.monitor.events if e.stage == "accommodation" for t in e.faults]
    assert named[0] == "viscous_friction"
    assert after[-1] in {Stage.IDLE, Stage.HEALTHY}


def test_without_faults_given_there_are_some_of_the_arms_size():
    source = simulated("scara", (), True, quiet)
    assert len(source.faults) == len({f.label for f in source.faults}) >= 3
    assert not source.acting


def test_what_cannot_be_prepared_says_why():
    with pytest.raises(CdiaError, match="joint9"):
        arm("viscous_friction@joint9: coefficient=1")
    with pytest.raises(CdiaError, match="twice"):
        arm(FAULT, FAULT)
    with pytest.raises(CdiaError, match="ur55"):
        simulated("ur55", (), True, quiet)


def test_a_log_is_watched_after_its_healthy_part(tmp_path):
    loop_log = tmp_path / "run.csv"
    source = arm()
    ticks = list(islice(source.ticks, 6000))
    write_log(log_of(source, ticks), loop_log)
    replay = replayed("double_pendulum", loop_log, quiet)
    times = [t.time for t in islice(replay.ticks, 2000)]
    assert times[0] == pytest.approx(5.0, abs=0.01)
    assert "5 s are taken as healthy" in replay.notes[0]
    assert replay.faults == ()


def log_of(source, ticks):
    columns = (np.array([getattr(t, name) for t in ticks]) for name in ("time", "q", "effort", "v"))
    return Log(source.robot.joints, *columns)


def test_a_run_gives_frames_at_the_pace_of_a_clock(watched):  # by which everything is compiled
    begun = time.monotonic()
    run = LiveRun(arm())
    new = run.frames.reader()
    piece = taken(run, new)
    while piece["time"][-1] < 1.0:
        more = taken(run, new)
        piece = {key: [*piece[key], *more[key]] for key in piece if key != "label"}
    passed = time.monotonic() - begun
    assert piece["time"][-1] < passed + 0.1
    assert len(piece["time"]) <= 1 + FRAMES * passed
    assert {len(rows) for rows in piece.values()} == {len(piece["time"])}
    run.pause(True)
    time.sleep(0.5)
    assert len(new().get("time", [])) <= 1  # one may have been under way
    time.sleep(0.5)
    assert (new(), run.events) == ({}, ())
    run.pause(False)
    assert taken(run, new)["time"][0] > piece["time"][-1]
    run.stop()
    deadline = time.monotonic() + 60.0
    while not run.ended and time.monotonic() < deadline:
        time.sleep(0.02)
    assert run.ended
    assert run.error == ""


def taken(run, new):
    """Wait for frames and take them."""
    deadline = time.monotonic() + 60.0
    while not (piece := new()):
        assert time.monotonic() < deadline, run.error
        time.sleep(0.05)
    return piece


def test_an_arm_that_runs_away_ends_the_run_with_a_reason(watched):
    source, _ = watched

    def lost():
        yield from ()
        raise CdiaError("the simulation diverged")

    run = LiveRun(Source(source.robot, source.monitor, lost(), source.reach))
    run._thread.join(5.0)
    assert run.ended
    assert run.error == "the simulation diverged"


def test_a_fault_of_the_program_ends_the_run_with_a_way_on(watched, monkeypatch, tmp_path, capfd):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    source, _ = watched

    def crashed():
        yield from ()
        raise ZeroDivisionError("float division by zero")

    run = LiveRun(Source(source.robot, source.monitor, crashed(), source.reach))
    run._thread.join(5.0)
    assert run.ended
    assert "ZeroDivisionError: float division by zero" in run.error
    assert run.error.endswith("Begin anew, with other faults or another log.")
    (file,) = tmp_path.glob("cdia-error-*.txt")
    assert str(file) in run.error and "in crashed" in file.read_text()
    assert "Traceback" not in "".join(capfd.readouterr())
