"""The journal keeps looks and beliefs over time, and does not change what the monitor reports."""

import numpy as np
import pytest

from cdia_pin import Dynamics, Monitor, exciting_trajectory, load_robot, simulate
from cdia_pin.diagnosis import replay
from cdia_pin.diagnosis.journal import Journal
from cdia_pin.dynamics.sensors import Sensors
from cdia_pin.effects import parse_term


def measured(seed, *faults):
    robot = load_robot("scara")
    motion_of, noise = np.random.default_rng(seed).spawn(2)
    motion = exciting_trajectory(robot, motion_of, duration=12.0)
    plant = Dynamics(robot, tuple(parse_term(f) for f in faults))
    return simulate(plant, motion, rate=250.0, sensors=Sensors(effort_share=0.01), rng=noise)


@pytest.fixture(scope="module")
def watched():
    monitor = Monitor(Dynamics(load_robot("scara")), healthy=[measured(1)])
    log = measured(2, "coulomb_friction@joint1: level=5, after=4, until=9")
    return monitor, log, replay(monitor, log)


def test_a_journal_does_not_change_the_events(watched):
    monitor, log, run = watched
    alone = Monitor(Dynamics(load_robot("scara")), healthy=[measured(1)]).replay(log)
    assert [(e.time, e.stage, e.joints, e.faults) for e in alone] == [
        (e.time, e.stage, e.joints, e.faults) for e in run.events
    ]
    again = replay(monitor, log)
    assert again.looks == run.looks
    assert [b.time for b in again.beliefs] == [b.time for b in run.beliefs]


def test_the_isolated_effect_was_leading_before(watched):
    _, _, run = watched
    isolated = next(e for e in run.events if e.stage == "isolation")
    before = [look for look in run.looks if look.time <= isolated.time]
    assert before[-1].joint == isolated.joints[0]
    assert before[-1].leading == tuple(t.effect.name for t in isolated.faults)
    assert before[0].time > next(e.time for e in run.events if e.stage == "detection")


def test_no_hypothesis_is_left_when_a_fault_has_cleared(watched):
    _, _, run = watched
    idle = next(e for e in run.events if e.stage == "idle")
    after = [look for look in run.looks if look.time >= idle.time]
    assert after[0].leading == ()
    assert run.beliefs[-1].faults == run.faults == ()


def test_intervals_of_a_believed_fault_shrink(watched):
    _, _, run = watched
    widths = [np.ptp(t.ci95[0]) for b in run.beliefs for t in b.faults if t.ci95]
    assert len(widths) > 5
    assert widths[-1] < widths[0]


def test_two_journals_keep_the_same(watched):
    monitor, log, run = watched
    first, second = Journal(monitor), Journal(monitor)
    monitor.replay(log, lambda status: (first(status), second(status)))
    assert first.looks == second.looks == list(run.looks)


def test_a_journal_that_starts_late_has_no_old_looks(watched):
    monitor, log, _ = watched
    monitor.replay(log)
    assert any(monitor.engine.decisions)
    late = Journal(monitor)
    late(monitor.update(float(log.time[-1]) + 0.004, log.position[-1], log.velocity[-1], log.effort[-1]))
    assert late.looks == []
    monitor.reset()
    assert not any(monitor.engine.decisions)


def test_an_engine_without_decisions_has_no_looks(watched):
    _, log, _ = watched
    monitor = Monitor(Dynamics(load_robot("scara")), healthy=[measured(1)], engine="thesis")
    assert replay(monitor, log).looks == ()
