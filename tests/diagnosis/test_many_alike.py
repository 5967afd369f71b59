"""A name that fits no better than three others, or explains little, is no name yet."""

from __future__ import annotations

import numpy as np
import pytest

from cdia_pin import Dynamics, Monitor, load_robot
from cdia_pin.diagnosis.belief import JointBelief
from cdia_pin.diagnosis.isolation import Decision
from cdia_pin.diagnosis.joint_isolation import JointIsolation
from cdia_pin.diagnosis.joint_monitor import JointMonitor


def said_with(rivals: int, monkeypatch: pytest.MonkeyPatch, left: float = 0.0) -> list[str]:
    """What a joint says for three seconds in which every look finds one effect, so many rivals, and leaves a share.

    Args:
        rivals: Number of rivals.
        monkeypatch: Of pytest.
        left: Share of the residual's mean square that the effect does not explain [1].
    """
    robot = load_robot("scara")
    monitor = Monitor(Dynamics(robot), threshold=dict.fromkeys(robot.joints, 1.0), rate=1000.0)
    joint: JointMonitor = monitor.engine.joint_monitors[0]
    theta = np.zeros(joint.bank.width)
    theta[0] = 1.0
    decision = Decision(1, theta, tuple((2 << k, theta) for k in range(rivals)), 0.1)
    monkeypatch.setattr(JointIsolation, "is_enough", True)
    gram = np.zeros((joint.bank.width + 1, joint.bank.width + 1))
    gram[0, 0] = gram[0, -1] = 1.0
    gram[-1, -1] = 1.0 / (1.0 - left)
    monkeypatch.setattr(JointIsolation, "gram", gram)
    monkeypatch.setattr(joint.isolation, "decide", lambda **_: decision)
    belief = JointBelief(theta, 1, "ambiguous", np.array([[0.5, 1.5]]), decision.rivals)
    monkeypatch.setattr(joint.isolation, "belief", lambda *_: belief)
    events = joint.alarm(0.0)
    for t in np.arange(0.05, 3.0, 0.05):
        events += joint.look(float(t))
    return [e.stage for e in events]


def test_two_rivals_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "isolation" in said_with(2, monkeypatch)


def test_three_rivals_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    assert said_with(3, monkeypatch) == ["detection"]


@pytest.mark.parametrize(
    ("left", "said"), [(0.1, ["detection", "isolation", "accommodation"]), (0.4, ["detection", "idle"])]
)
def test_a_name_must_explain_most_of_the_residual(
    left: float, said: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert said_with(0, monkeypatch, left) == said
