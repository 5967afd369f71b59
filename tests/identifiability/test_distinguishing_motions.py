"""What tells explanations apart follows from the formulas of their effects."""

from itertools import combinations

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.effects import (
    EFFECTS,
    JointEffect,
    Parameter,
    Payload,
    PerLog,
    Signal,
    State,
    StatefulEffect,
    Traits,
    from_expression,
    parse_effect,
)
from cdia_pin.identifiability import distinguishing_motion, motion_between, why_alike
from cdia_pin.identifiability.distinguishing_motions import KINDS
from cdia_pin.identifiability.structural_rank import are_alike

JOINT = "elbow_joint"
SWEEP, POSES, SPEEDS, REVERSALS, EVERYTHING = (k.said([JOINT]) for k in KINDS)
ON_ONE_JOINT = [
    kind(joint=JOINT)
    for kind in EFFECTS.values()
    if issubclass(kind, JointEffect) and kind.name not in {"unknown", "expression"}
]
OWN = [from_expression(text, JOINT) for text in ("sin(3*q)*dq", "ddq*cos(q)", "tau*q")]


@pytest.fixture(scope="module")
def ur5():
    return load_robot("ur5")


def effect(name):
    return parse_effect(f"{name}@{JOINT}")


def driven(robot, words, seed):
    """Other states of the kind of motion that was advised than those by which it was chosen."""
    kind = next(k for k in KINDS if k.said([JOINT]) == words)
    q, v, a, time = kind.draw(robot, np.isin(robot.joints, JOINT), np.random.default_rng(seed))
    return State(robot, q, v, a, robot.inverse_dynamics(q, v, a), time)


def imitates(x, one, other):
    """Whether one effect can do on a motion what the other does."""
    wide, narrow = (e.basis(x).reshape(x.q.size, -1) for e in (one, other))
    left = narrow - wide @ np.linalg.lstsq(wide, narrow, rcond=None)[0]
    return np.linalg.norm(left) < 1e-3 * np.linalg.norm(narrow)


@pytest.mark.parametrize(
    ("joints", "said"), [((JOINT,), "the joint "), ((), "the joints "), (("a", "b"), "the joints ")]
)
def test_a_motion_is_of_the_joints_that_the_effects_name(joints, said):
    for kind in KINDS[:3]:
        assert said in kind.said(joints).replace(",", " ")


@pytest.mark.parametrize(
    ("one", "other"),
    [p for p in combinations([*ON_ONE_JOINT, *OWN], 2) if p[0].traits.sensed.meets(p[1].traits.sensed)],
    ids=lambda e: e.label,
)
def test_two_effects_differ_on_the_motion_that_is_advised(ur5, one, other):
    assert not are_alike(ur5, one, other)
    x = driven(ur5, motion_between(one, other, ur5), seed=1)
    assert not (imitates(x, one, other) and imitates(x, other, one))


@pytest.mark.parametrize(
    ("one", "other", "motion"),
    [
        ("coulomb_friction", "viscous_friction", SPEEDS),
        ("viscous_friction", "quadratic_friction", SPEEDS),
        ("coulomb_friction", "stribeck_friction", SPEEDS),
        ("torque_offset", "joint_spring", SWEEP),
        ("torque_offset", "actuator_gain", SWEEP),
    ],
)
def test_the_advice_is_what_an_engineer_would_drive(ur5, one, other, motion):
    assert motion_between(effect(one), effect(other), ur5) == motion


def test_a_product_needs_both_of_its_signals_to_vary(ur5):
    """A slow sweep varies the position, but ddq·cos(q) shows only where the joint accelerates as well."""
    own = from_expression("ddq*cos(q)", JOINT)
    assert motion_between(own, effect("rotor_inertia"), ur5) == EVERYTHING


def test_a_gain_beside_friction_needs_another_load(ur5):
    gain, coulomb = effect("actuator_gain"), effect("coulomb_friction")
    assert distinguishing_motion([[gain, coulomb], [coulomb]], ur5) in {SWEEP, POSES}


def test_no_explanation_at_all_still_gets_advice(ur5):
    assert distinguishing_motion([[], []], ur5)


def test_bodies_on_one_link_differ_on_no_motion(ur5):
    last = parse_effect(f"link_inertia@{ur5.joints[-1]}")
    assert motion_between(Payload(), last, ur5).startswith("no motion of this arm")
    assert "tool taken off" in why_alike([Payload()], [last], ur5)


class Presliding(StatefulEffect):
    """Friction that builds up over a distance, level · z, dz = (1 − |z|) dq / reach."""

    name = "presliding"
    equation = "−α z"
    traits = Traits({Signal.POSITION, Signal.TIME})
    parameters = (Parameter("level", "{effort}"),)

    def initial_state(self, robot):
        return np.zeros(1)

    def step(self, z, x, dq, dt):
        sign = np.sign(dq)
        return sign + (z - sign) * np.exp(-abs(dq) / 0.02)

    def columns(self, x):
        return [-x.memory[:, 0]]


def test_friction_with_memory_shows_where_the_joint_reverses_often(ur5):
    """On a long stroke it is Coulomb friction; only the way after a reversal differs."""
    memory, coulomb = Presliding(JOINT), effect("coulomb_friction")
    advice = motion_between(memory, coulomb, ur5)
    assert advice in {SPEEDS, REVERSALS}  # both go back after a short way
    assert not imitates(driven(ur5, advice, seed=1), coulomb, memory)


def test_an_effect_of_each_log_differs_from_the_common_one_between_logs_only(ur5):
    common = effect("coulomb_friction")
    assert motion_between(PerLog(common, ("monday", "friday")), common, ur5).endswith("compare logs")
