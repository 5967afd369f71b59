"""A joint that is given one name after the other has a fault that none of them describes."""

from __future__ import annotations

import numpy as np
import pytest

from cdia_pin import Dynamics, Monitor, load_robot
from cdia_pin.diagnosis.belief import JointBelief
from cdia_pin.diagnosis.isolation import Decision
from cdia_pin.diagnosis.joint_isolation import JointIsolation
from cdia_pin.diagnosis.joint_monitor import JointMonitor
from cdia_pin.diagnosis.status import Event, Verdict
from cdia_pin.diagnosis.tried_names import HOLDING_TIME

BANK = ["coulomb_friction", "viscous_friction", "actuator_gain"]
LOOK = 0.05  # [s]


def said_of(names: list[str], each: float, monkeypatch: pytest.MonkeyPatch) -> list[Event]:
    """What a joint says if every look finds one name after the other.

    Args:
        names: Effects of the bank.
        each: How long each is found [s].
        monkeypatch: Of pytest.
    """
    robot = load_robot("scara")
    monitor = Monitor(Dynamics(robot), threshold=dict.fromkeys(robot.joints, 1.0), rate=1000.0, bank=BANK)
    joint: JointMonitor = monitor.engine.joint_monitors[0]
    gram = np.zeros((joint.bank.width + 1, joint.bank.width + 1))
    gram[:3, :3], gram[:, -1] = np.eye(3), 1.0
    monkeypatch.setattr(JointIsolation, "is_enough", True)
    monkeypatch.setattr(JointIsolation, "weight", 1e9)
    monkeypatch.setattr(JointIsolation, "gram", gram)
    events, decided = joint.alarm(0.0), list[Decision]()
    monkeypatch.setattr(joint.isolation, "decide", lambda **_: decided[-1])
    monkeypatch.setattr(joint.isolation, "belief", lambda *_: belief(decided[-1]))
    for t in np.arange(LOOK, each * len(names), LOOK):
        bit = BANK.index(names[int(t // each)])
        decided.append(Decision(1 << bit, np.eye(3)[bit], (), 0.1))
        events += joint.look(float(t))
    return [e for e in events if e.stage == "isolation"]


def belief(decision: Decision) -> JointBelief:
    return JointBelief(decision.theta, decision.mask, Verdict.UNIQUE, np.array([[0.5, 1.5]]))


def test_the_third_name_that_does_not_last_makes_the_fault_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    said = said_of([*BANK, BANK[0]], 2.0, monkeypatch)
    assert [str(e.verdict) for e in said] == ["unique", "unique", "unique", "unknown"]


def test_a_name_that_held_for_long_was_right(monkeypatch: pytest.MonkeyPatch) -> None:
    said = said_of([*BANK, BANK[0]], HOLDING_TIME + 2.0, monkeypatch)
    assert [str(e.verdict) for e in said] == ["unique"] * 4


def test_one_name_is_not_its_own_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    assert len(said_of(BANK[:1] * 4, 2.0, monkeypatch)) == 1
