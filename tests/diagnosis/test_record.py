"""What is kept of a run: some ticks, every event, and where it came from."""

import json

import numpy as np
import pytest

from cdia_pin import Dynamics, Monitor, load_robot
from cdia_pin.diagnosis import Event, Recorder, Stage, Status, Verdict
from cdia_pin.diagnosis.record import STAGES


@pytest.fixture
def monitor():
    robot = load_robot("double_pendulum")
    return Monitor(Dynamics(robot), threshold={"joint1": 1.0, "joint2": 2.0}, rate=1000.0)


def status(t, stages=(Stage.HEALTHY, Stage.HEALTHY), events=()):
    return Status(t, stages, np.array([t, -t]), np.ones(2), np.zeros(2), (), events)


def test_ticks_are_thinned_and_events_are_kept(monitor):
    recorder = Recorder(monitor, rate=100.0)
    surprise = Event(0.5033, "detection", ("joint1",), Verdict.NONE)
    for k in range(1000):
        t = 1e-3 * k
        recorder(status(t), np.zeros(2), None, np.zeros(2))
        if k == 503:
            recorder(
                status(0.5033, (Stage.DETECTED, Stage.HEALTHY), (surprise,)), np.zeros(2), None, np.zeros(2)
            )
    run = recorder.finish()
    assert len(run.time) == 101
    assert 0.5033 in run.time
    regular = run.time[run.time != 0.5033]
    np.testing.assert_allclose(np.diff(regular), 0.01, atol=1e-9)
    assert STAGES[run.stages[list(run.time).index(0.5033), 0]] is Stage.DETECTED
    assert run.velocity is None
    assert run.desired is None
    assert run.tracking_rms() == {}


def test_a_slow_monitor_loses_no_tick(monitor):
    recorder = Recorder(monitor, rate=100.0)
    times = np.cumsum(np.random.default_rng(0).uniform(0.015, 0.025, 300))
    for t in times:
        recorder(status(t), np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2))
    np.testing.assert_array_equal(recorder.finish().time, times)


def test_time_that_goes_back_is_recorded(monitor):
    recorder = Recorder(monitor, rate=100.0)
    for t in (*(10.0 + 1e-3 * np.arange(50)), *(3.0 + 1e-3 * np.arange(50))):
        recorder(status(float(t)), np.zeros(2), None, np.zeros(2))
    time = recorder.finish().time
    np.testing.assert_allclose(time, [10.0, 10.01, 10.02, 10.03, 10.04, 3.0, 3.01, 3.02, 3.03, 3.04])


def test_tracking_is_the_rms_from_a_time_on(monitor):
    recorder = Recorder(monitor)
    for t, far in ((0.0, 3.0), (1.0, 1.0), (2.0, -1.0)):
        recorder(status(t), np.array([far, 0.0]), np.zeros(2), np.zeros(2), np.zeros(2))
    run = recorder.finish()
    assert run.tracking_rms(since=1.0) == {"joint1": 1.0, "joint2": 0.0}
    assert run.tracking_rms()["joint1"] == pytest.approx(np.sqrt(11 / 3))


def test_the_document_is_the_schema_and_plain_json(monitor):
    recorder = Recorder(monitor)
    recorder(status(0.0), np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2))
    document = recorder.finish(log={"source": "run.csv"}).to_dict()
    assert document["schema"] == "cdia-events/1"
    assert set(document) >= {"robot", "joints", "events", "faults", "tracking_rms", "record"}
    assert document["record"]["engine"] == "momentum"
    assert document["record"]["log"] == {"source": "run.csv"}
    assert json.loads(json.dumps(document, allow_nan=False)) == document
