"""The monitor in the loop with an arm that is not its model: a few cases of each kind, a few seconds each.

What is measured over all cases is in docs/results-online.md; here are cases that must not be lost again.
"""

from functools import cache

import pytest

pytest.importorskip("mujoco")

from benchmarks.online import scenarios as s
from benchmarks.online.outcome import JointOutcome, Outcome
from benchmarks.online.scenarios import Case
from benchmarks.online.trial import run_case

HOLD = 1.3  # times as far from the reference as a healthy arm [1]


@pytest.fixture(scope="session")
def outcome_of():
    """Run a case once; an arm's monitor learns once."""
    return cache(lambda arm, suite, k: run_case(case(arm, suite, k), minutes=1))


SUITES = {
    "single": lambda arm: s.singles(arm, 0.5, ["viscous_friction", "actuator_gain", "torque_offset"], 1),
    "pair": s.pairs,
    "triple": s.triples,
    "unknown": lambda arm: s.unknown(arm, 0.5, 1),
    "return": s.returning,
    "joining": s.joining,
    "healthy": lambda arm: s.healthy(arm, 3),
}


def case(arm: str, suite: str, k: int) -> Case:
    return SUITES[suite](arm)[k]


def only_joint(outcome: Outcome) -> JointOutcome:
    (joint,) = outcome.joints
    assert joint.detected, outcome.said
    assert outcome.false_alarms == 0, outcome.said
    return joint


@pytest.mark.parametrize("arm", s.ARMS)
@pytest.mark.parametrize("k", range(3))  # ten seconds each
def test_healthy_motion_raises_no_alarm(outcome_of, arm: str, k: int) -> None:
    outcome = outcome_of(arm, "healthy", k)
    assert outcome.false_alarms == 0, outcome.said
    assert outcome.said == ()


@pytest.mark.parametrize(
    ("arm", "suite", "k"),
    [
        ("scara", "single", 0),
        ("ur5", "single", 1),
        ("panda", "single", 2),
        ("xarm7", "single", 0),
        ("panda", "pair", 0),
        ("ur5", "triple", 0),
    ],
)
def test_a_fault_is_detected_at_once_named_and_compensated(outcome_of, arm: str, suite: str, k: int) -> None:
    outcome = outcome_of(arm, suite, k)
    joint = only_joint(outcome)
    assert joint.delay < 0.2
    assert joint.holds, outcome.said
    assert joint.tracking < HOLD
    assert joint.against_none < 0.5


def test_what_no_effect_explains_is_called_unknown_and_its_torque_is_recovered(outcome_of) -> None:
    outcome = outcome_of("panda", "unknown", 2)
    joint = only_joint(outcome)
    assert joint.verdict == "unknown", outcome.said
    assert joint.recovered > 0.9
    assert joint.against_none < 0.5


def test_a_fault_that_vanishes_is_dropped_and_found_again_when_it_returns(outcome_of) -> None:
    outcome = outcome_of("ur5", "return", 2)
    only_joint(outcome)
    assert outcome.drop < 1.0, outcome.said
    assert outcome.again < 3.0, outcome.said


def test_a_fault_that_joins_another_on_its_joint_is_named_beside_it(outcome_of) -> None:
    outcome = outcome_of("panda", "joining", 0)
    joint = only_joint(outcome)
    assert joint.holds, outcome.said
    assert joint.against_none < 0.5
