"""What a joint decided by itself of late is taken back when one cause of the whole arm explains it."""

import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings
from cdia_pin.diagnosis.status import Event, EventStage, Verdict
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
