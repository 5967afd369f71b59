"""Events: the last ones in memory, all of them on disk, and no exception in the loop whatever the disk does."""

import json
import resource
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, Monitor, load_robot, schemas
from cdia_pin.diagnosis.event_history import MOST_EVENTS
from cdia_pin.diagnosis.event_log_file import MOST_WAITING
from cdia_pin.diagnosis.status import Event, EventStage, Verdict
from cdia_pin.errors import ModelError


@pytest.fixture
def talkative(tmp_path):
    """A monitor whose engine says something at every tick, and its file."""
    robot, path = load_robot("double_pendulum"), tmp_path / "logs" / "events.jsonl"
    path.parent.mkdir()
    threshold = dict.fromkeys(robot.joints, 1.0)
    monitor = Monitor(Dynamics(robot), threshold=threshold, rate=1000.0, event_log=path)
    update = monitor.engine.update

    def talk(t, q, v, tau):
        status = update(t, q, v, tau)
        return replace(
            status, events=(Event(t, EventStage.DETECTION, robot.joints, Verdict.NONE, reason="test"),)
        )

    monitor.engine.update = talk
    return monitor, path


def ticks(monitor, begin, end):
    q = np.zeros(2)
    for k in range(begin, end):
        status = monitor.update(1e-3 * k, q, q, q)
    return status


def lines(path):
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def test_memory_does_not_grow_with_the_number_of_events(talkative):
    monitor, path = talkative
    ticks(monitor, 0, 3 * MOST_EVENTS)
    tracemalloc.start()
    before = tracemalloc.take_snapshot()
    ticks(monitor, 3 * MOST_EVENTS, 9 * MOST_EVENTS)
    grown = sum(d.size_diff for d in tracemalloc.take_snapshot().compare_to(before, "filename"))
    tracemalloc.stop()
    assert len(monitor.events) == MOST_EVENTS
    # The events that replaced others are counted, those that they replaced are not: they are from before.
    assert grown < 2000 * MOST_EVENTS
    assert len(lines(path)) == 1 + 9 * MOST_EVENTS


def test_a_file_names_the_arm_and_holds_each_event_as_a_document_does(talkative):
    monitor, path = talkative
    ticks(monitor, 0, 3)
    header, *events = lines(path)
    assert header == {"schema": schemas.EVENT_LOG, "robot": "double_pendulum", "joints": ["joint1", "joint2"]}
    assert events == [e.to_dict(monitor.model.robot) for e in monitor.events]


def test_a_file_is_appended_to_and_a_start_shows(talkative):
    monitor, path = talkative
    ticks(monitor, 0, 2)
    monitor.reset()
    ticks(monitor, 0, 1)
    assert ["schema" in line for line in lines(path)] == [True, False, False, True, False]
    assert len(monitor.events) == 1


def test_a_disk_that_is_gone_is_noted_and_made_good(talkative):
    monitor, path = talkative
    path.parent.rename(path.parent.with_name("away"))
    status = ticks(monitor, 0, 5)
    assert "5 events" in status.warnings[0]
    assert len(monitor.events) == 5
    path.parent.mkdir()
    assert ticks(monitor, 5, 6).warnings == ()
    assert len(lines(path)) == 7


def test_a_full_disk_leaves_whole_lines_and_is_made_good(talkative):
    monitor, path = talkative
    ticks(monitor, 0, 1)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (path.stat().st_size + 30, before[1]))
    try:
        status = ticks(monitor, 1, 4)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert "3 events" in status.warnings[0]
    assert len(lines(path)) == 2
    assert ticks(monitor, 4, 5).warnings == ()
    assert [line["time"] for line in lines(path)[1:]] == pytest.approx([0.0, 0.001, 0.002, 0.003, 0.004])


def test_what_waits_for_a_disk_is_bounded_and_what_is_lost_is_counted(talkative):
    monitor, path = talkative
    path.parent.rename(path.parent.with_name("away"))
    ticks(monitor, 0, MOST_WAITING + 9)
    path.parent.mkdir()
    ticks(monitor, MOST_WAITING + 9, MOST_WAITING + 10)
    first, second, *rest = lines(path)
    assert first["schema"] == schemas.EVENT_LOG  # the line that names the arm is never lost
    assert second == {"lost": 10}
    assert len(rest) == MOST_WAITING


def test_a_place_that_cannot_be_written_is_refused_at_once(tmp_path):
    robot = load_robot("double_pendulum")
    threshold = dict.fromkeys(robot.joints, 1.0)
    for place in (tmp_path, tmp_path / "none" / "events.jsonl", "/dev/full"):
        with pytest.raises(ModelError, match="cannot write events"):
            Monitor(Dynamics(robot), threshold=threshold, rate=1000.0, event_log=place)
