"""What fits no better than three others, explains little, or follows few samples by many parameters is no name yet."""

from __future__ import annotations

import numpy as np
import pytest

from cdia_pin import Dynamics, Monitor, load_robot
from cdia_pin.diagnosis.belief import JointBelief
from cdia_pin.diagnosis.isolation import Decision
from cdia_pin.diagnosis.joint_isolation import JointIsolation
from cdia_pin.diagnosis.joint_monitor import JointMonitor


def said_with(
    rivals: int, monkeypatch: pytest.MonkeyPatch, left: float = 0.0, effects: int = 1, samples: float = 1e9
) -> list[str]:
    """What a joint says for three seconds in which every look finds the same effects and rivals, and leaves a share.

    Args:
        rivals: Number of rivals.
        monkeypatch: Of pytest.
        left: Share of the residual's mean square that the effects do not explain [1].
        effects: Number of effects, of one parameter each.
        samples: Independent samples that it has collected [1].
    """
    robot = load_robot("scara")
    bank = ["coulomb_friction", "viscous_friction", "actuator_gain"]
    monitor = Monitor(Dynamics(robot), threshold=dict.fromkeys(robot.joints, 1.0), rate=1000.0, bank=bank)
    joint: JointMonitor = monitor.engine.joint_monitors[0]
    theta = np.zeros(joint.bank.width)
    theta[0] = 1.0
    mask = (1 << effects) - 1
    decision = Decision(mask, theta, tuple((2 << k, theta) for k in range(rivals)), 0.1)
    monkeypatch.setattr(JointIsolation, "is_enough", True)
    monkeypatch.setattr(JointIsolation, "weight", samples * joint.isolation.independent)
    gram = np.zeros((joint.bank.width + 1, joint.bank.width + 1))
    gram[0, 0] = gram[0, -1] = 1.0
    gram[-1, -1] = 1.0 / (1.0 - left)
    monkeypatch.setattr(JointIsolation, "gram", gram)
    monkeypatch.setattr(joint.isolation, "decide", lambda **_: decision)
    belief = JointBelief(theta, mask, "ambiguous", np.array([[0.5, 1.5]] * effects), decision.rivals)
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


@pytest.mark.parametrize(
    ("effects", "samples", "is_named"), [(1, 0.1, True), (3, 3.9, False), (3, 4.1, True)]
)
def test_each_further_parameter_takes_two_independent_samples(
    effects: int, samples: float, is_named: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = said_with(0, monkeypatch, effects=effects, samples=samples)
    assert ("isolation" in said) == is_named
    assert said[0] == "detection"
