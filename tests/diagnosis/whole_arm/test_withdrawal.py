"""What joints, or the whole arm, decided of late is taken back, and said, when another cause explains all of it."""

import numpy as np
import pytest
from loaded_arms import ARM, loaded_run

from cdia_pin import Dynamics, load_robot
from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings
from cdia_pin.diagnosis import Monitor
from cdia_pin.diagnosis.status import WITHDRAWN, Event, EventStage, Stage, Verdict
from cdia_pin.diagnosis.whole_arm import arm_monitor
from cdia_pin.diagnosis.whole_arm.isolation import ArmDecision
from cdia_pin.diagnosis.whole_arm.question import Question
from cdia_pin.effects import parse_term

BEGIN = 2.0


@pytest.fixture
def isolated():
    """A momentum engine that has just isolated a fault of the second joint, and the rest of its log."""
    settings = LoopSettings(rate=500.0, healthy_runs=1, healthy_duration=10.0, seed=3)
    loop = ClosedLoop(Dynamics(load_robot("double_pendulum")), settings)
    monitor = loop.monitor(bank=("coulomb_friction", "viscous_friction"))
    log = loop.run(
        loop.motion(0, 7.0), [parse_term(f"coulomb_friction@joint2: level=0.2, after={BEGIN}")]
    ).log
    for k in range(len(log.time)):
        monitor.update(log.time[k], log.position[k], log.velocity[k], log.effort[k])
        if monitor.faults:
            return monitor, float(log.time[k])
    raise AssertionError("nothing was isolated")


@pytest.mark.parametrize(("since", "stays"), [(BEGIN, False), (BEGIN + 3.0, True)])
def test_a_cause_of_the_whole_arm_takes_back_what_a_joint_decided_since_it_began(
    isolated, monkeypatch, since, stays
):
    monitor, t = isolated
    engine = monitor.engine
    cause = Event(t, EventStage.ISOLATION, monitor.model.robot.joints, Verdict.UNIQUE, ())
    engine.arm._question = Question.of({1}, since)
    monkeypatch.setattr(engine.arm, "look", lambda *_: [cause])
    said = engine._look_at_arm(t, t)
    assert bool(engine.joint_monitors[1].faults) == stays
    assert [(e.stage, e.joints) for e in said[1:]] == ([] if stays else [(EventStage.IDLE, ("joint2",))])
    assert stays or "coulomb_friction@joint2" in {f.label for f in said[1].faults}


def test_a_load_that_another_cause_explains_better_is_said_to_be_withdrawn(monkeypatch):
    """Before, it was no longer believed, and no event said so."""
    monitor = Monitor(Dynamics(ARM), healthy=[loaded_run(1, duration=30.0)[1]])
    log = loaded_run(2, (4.0, np.inf), duration=10.0)[1]
    engine = monitor.engine
    for k in range(len(log.time)):
        status = monitor.update(log.time[k], log.position[k], None, log.effort[k])
        if any(e.stage is EventStage.ISOLATION and e.faults[0].label == "payload" for e in status.events):
            break
    (load,) = status.faults
    engine.joint_monitors[1].stage = Stage.DETECTED
    tilt = ArmDecision(1, np.array([1.0, 0.5]), 1e3 * np.eye(2), lead=30.0, explained=0.99)
    monkeypatch.setattr(arm_monitor, "decide", lambda *_: tilt)
    said = engine._look_at_arm(status.time, status.time)
    assert [(e.stage, e.faults, e.reason) for e in said] == [(EventStage.IDLE, (load,), WITHDRAWN)]
    assert not engine.arm.believed
    assert engine.joint_monitors[1].is_undecided, "the alarm is still asked about"
