"""Terms as people type them."""

import pytest

from cdia_pin.effects import (
    ALWAYS,
    Between,
    CoulombFriction,
    CoupledFriction,
    Expression,
    Incipient,
    Intermittent,
    Payload,
    PositionRipple,
    Region,
    Term,
    after,
    parse_effect,
    parse_term,
)
from cdia_pin.errors import EffectError, RobotError
from cdia_pin.robot import load_robot

ELBOW = CoulombFriction("elbow_joint")


@pytest.mark.parametrize(
    ("text", "term"),
    [
        ("coulomb_friction@elbow_joint: level=5", Term(ELBOW, (5.0,))),
        ("  coulomb_friction @ elbow_joint :level = 5e0 , ", Term(ELBOW, (5.0,))),
        ("coulomb_friction@elbow_joint", Term(ELBOW, (0.0,))),
        ("coulomb_friction@elbow_joint: level=5, after=4", Term(ELBOW, (5.0,), after(4.0))),
        ("coulomb_friction@elbow_joint: after=1, until=2", Term(ELBOW, (0.0,), Between(1.0, 2.0))),
        ("coulomb_friction@elbow_joint: until=2", Term(ELBOW, (0.0,), Between(end=2.0))),
        ("coulomb_friction@elbow_joint: rate=2", Term(ELBOW, (0.0,), Incipient(0.0, 2.0))),
        ("coulomb_friction@elbow_joint: after=3, rate=2", Term(ELBOW, (0.0,), Incipient(3.0, 2.0))),
        (
            "coulomb_friction@elbow_joint: period=2, duty=.3, after=1",
            Term(ELBOW, (0.0,), Intermittent(1.0, 2.0, 0.3)),
        ),
        (
            "coulomb_friction@elbow_joint: speed=..0.3",
            Term(ELBOW, (0.0,), Region("elbow_joint", "speed", upper=0.3)),
        ),
        (
            "coulomb_friction@elbow_joint: q=-1..0.5",
            Term(ELBOW, (0.0,), Region("elbow_joint", "position", -1.0, 0.5)),
        ),
        ("payload: mass=1.5", Term.of(Payload(), mass=1.5)),
        ("coupled_friction@a+b: level=1", Term.of(CoupledFriction("a", "b"), level=1.0)),
        ("position_ripple@a: frequency=12, sine=2", Term.of(PositionRipple("a", 12.0), sine=2.0)),
        ("sin(3*q)*dq@a: coefficient=2", Term(Expression("a", "sin(3*q)*dq"), (2.0,))),
        ("maximum(q, 0)@a: coefficient=2", Term(Expression("a", "maximum(q, 0)"), (2.0,))),
        ("rate*q@a: rate=2", Term(Expression("a", "rate*q"), (2.0,))),  # a parameter before a profile
    ],
)
def test_a_term_is_read_as_it_is_written(text, term):
    assert parse_term(text) == term


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "unknown effect"),
        ("coulomb_frction@elbow_joint: level=5", "coulomb_friction"),
        ("coulomb_friction: level=5", "write coulomb_friction@JOINT"),
        ("coulomb_friction@: level=5", "write coulomb_friction@JOINT"),
        ("coulomb_friction@a+b: level=5", "takes 1 joint"),
        ("coupled_friction@a: level=5", "write coupled_friction@JOINT"),
        ("coupled_friction@a+: level=5", "write coupled_friction@JOINT"),
        ("coupled_friction@a+a: level=5", "two different joints"),
        ("payload@a: mass=1", "write payload"),
        ("coulomb_friction@a: levle=5", "given levle"),
        ("coulomb_friction@a: level", "name=value"),
        ("coulomb_friction@a: level=", "name=value"),
        ("coulomb_friction@a: =5", "name=value"),
        ("coulomb_friction@a: level=five", "'five'"),
        ("coulomb_friction@a: level=5 N", "'5 N'"),
        ("coulomb_friction@a: level=nan", "finite"),
        ("coulomb_friction@a: level=inf", "finite"),
        ("coulomb_friction@a: level=1, level=2", "twice"),
        ("position_ripple@a: frequency=0", "frequency must lie within"),
        ("position_ripple@a: frequency=nan", "frequency must lie within"),
        ("coulomb_friction@a: after=4, until=3", "start before it ends"),
        ("coulomb_friction@a: until=5, rate=2", "do not make a profile"),
        ("coulomb_friction@a: rate=2, period=3", "do not make a profile"),
        ("coulomb_friction@a: duty=0.5", "do not make a profile"),
        ("coulomb_friction@a: q=0..1, after=2", "do not make a profile"),
        ("coulomb_friction@a: q=0..1, dq=0..1", "do not make a profile"),
        ("coulomb_friction@a: q=1", r"q=LOWER\.\.UPPER"),
        ("coulomb_friction@a: q=..", r"q=LOWER\.\.UPPER"),
        ("coulomb_friction@a: q=2..1", "begin below its end"),
        ("payload: mass=1, q=0..1", "needs an effect of one joint"),
        ("coulomb_friction@a: rate=-1", "rate above 0"),
    ],
)
def test_a_mistake_is_named(text, message):
    with pytest.raises(EffectError, match=message) as error:
        parse_term(text)
    assert "\n" not in str(error.value)


def test_joints_are_checked_against_a_robot_if_it_is_given():
    robot = load_robot("scara")
    assert parse_effect("coupled_friction@joint1+joint2", robot).acts_on(robot) == (0, 1)
    with pytest.raises(RobotError, match="joint5"):
        parse_effect("coulomb_friction@joint5", robot)
    with pytest.raises(RobotError, match="joint5"):
        parse_term("coulomb_friction@joint5: level=1", robot)
    with pytest.raises(EffectError, match="cannot share a gear"):
        parse_effect("coupled_friction@joint3+joint4", robot)


def test_profiles_are_always_unless_asked_for():
    assert parse_term("payload").profile == ALWAYS
