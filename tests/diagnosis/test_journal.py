"""What a monitor thought is kept, and keeping it changes nothing of what it says."""

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


def test_the_monitor_says_the_same_whoever_listens(watched):
    monitor, log, run = watched
    alone = Monitor(Dynamics(load_robot("scara")), healthy=[measured(1)]).replay(log)
    assert [(e.time, e.stage, e.joints, e.faults) for e in alone] == [
        (e.time, e.stage, e.joints, e.faults) for e in run.events
    ]
    again = replay(monitor, log)
    assert again.looks == run.looks
    assert [b.time for b in again.beliefs] == [b.time for b in run.beliefs]


def test_the_effect_that_is_isolated_led_before(watched):
    _, _, run = watched
    isolated = next(e for e in run.events if e.stage == "isolation")
    before = [look for look in run.looks if look.time <= isolated.time]
    assert before[-1].joint == isolated.joints[0]
    assert before[-1].leading == tuple(t.effect.name for t in isolated.faults)
    assert before[0].time > next(e.time for e in run.events if e.stage == "detection")


def test_nothing_is_live_once_a_fault_is_gone(watched):
    _, _, run = watched
    idle = next(e for e in run.events if e.stage == "idle")
    after = [look for look in run.looks if look.time >= idle.time]
    assert after[0].leading == ()
    assert run.beliefs[-1].faults == run.faults == ()


def test_beliefs_grow_surer(watched):
    _, _, run = watched
    widths = [np.ptp(t.ci95[0]) for b in run.beliefs for t in b.faults if t.ci95]
    assert len(widths) > 5
    assert widths[-1] < widths[0]


def test_two_journals_hear_the_same(watched):
    monitor, log, run = watched
    first, second = Journal(monitor), Journal(monitor)
    monitor.replay(log, lambda status: (first(status), second(status)))
    assert first.looks == second.looks == list(run.looks)


def test_a_journal_that_begins_late_notes_nothing_old(watched):
    monitor, log, _ = watched
    monitor.replay(log)
    assert any(monitor.engine.decisions)
    late = Journal(monitor)
    late(monitor.update(float(log.time[-1]) + 0.004, log.position[-1], log.velocity[-1], log.effort[-1]))
    assert late.looks == []
    monitor.reset()
    assert not any(monitor.engine.decisions)


def test_of_an_engine_that_takes_no_decisions_there_are_no_looks(watched):
    _, log, _ = watched
    monitor = Monitor(Dynamics(load_robot("scara")), healthy=[measured(1)], engine="thesis")
    assert replay(monitor, log).looks == ()
