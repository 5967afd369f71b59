"""The bank: any effect of one joint can be in a bank, once, and the columns stand side by side."""

import numpy as np
import pytest

from cdia_pin.diagnosis import DEFAULT_BANK, Bank
from cdia_pin.diagnosis.bank import MOST_EFFECTS, bare, is_followed, on_joint
from cdia_pin.effects import EFFECTS, CoulombFriction, JointEffect, Region
from cdia_pin.errors import EffectError
from cdia_pin.logs.torque_side import TorqueSide
from cdia_pin.robot import load_robot

ROBOT = load_robot("ur5")
OF_JOINT = [
    n
    for n, e in EFFECTS.items()
    if issubclass(e, JointEffect) and n not in ("unknown", "expression") and is_followed(e(ROBOT.joints[0]))
]


def test_every_effect_of_one_joint_can_be_in_a_bank() -> None:
    for names in (OF_JOINT[:MOST_EFFECTS], OF_JOINT[-MOST_EFFECTS:]):
        bank = Bank.of(ROBOT, names)
        assert bank.names == tuple(names)
        assert len(bank) == len(names)


def test_columns_stand_side_by_side_with_their_bounds() -> None:
    bank = Bank.of(ROBOT)
    assert bank.names == DEFAULT_BANK
    spans = [bank.span(i) for i in range(len(bank))]
    assert [s.stop - s.start for s in spans] == [p.size for p in bank.prototypes]
    assert np.concatenate([np.arange(s.start, s.stop) for s in spans]).tolist() == list(range(bank.width))
    np.testing.assert_array_equal(bank.columns([0, 4]), [0, *range(spans[4].start, spans[4].stop)])
    assert bank.columns([]).dtype.kind == "i"
    lower, upper = bank.bounds
    assert lower[spans[0]] == 0.0  # dry friction does not push
    assert lower[spans[3]] == -np.inf  # an offset may have either sign
    assert (lower < upper).all()


def test_behind_the_gear_the_usual_effects_are_those_that_a_sensor_sees_there() -> None:
    assert Bank.usual(ROBOT).names == DEFAULT_BANK
    behind = Bank.usual(ROBOT, TorqueSide.LINK).names
    assert behind == ("bearing_friction", "actuator_gain", "torque_offset", "joint_spring", "position_ripple")


def test_an_effect_keeps_its_shape_and_goes_to_any_joint() -> None:
    bank = Bank.of(ROBOT, ["position_ripple: frequency=5", "sin(3*q)*dq"])
    assert bank.effect(0, "elbow_joint").label == "position_ripple@elbow_joint"
    assert bank.effect(0, "elbow_joint").shape_values == {"frequency": 5.0}
    assert bank.effect(1, "wrist_1_joint").label == "sin(3*q)*dq@wrist_1_joint"


def test_the_joint_does_not_matter_to_what_an_effect_is() -> None:
    bank = Bank.of(ROBOT, ["viscous_friction", CoulombFriction("wrist_3_joint")])
    assert bank.index(CoulombFriction("elbow_joint")) == 1
    assert bank.index(EFFECTS["torque_offset"](joint="elbow_joint")) is None
    assert bare(bank.effect(1, "elbow_joint")) == "coulomb_friction"


def test_an_effect_may_be_limited_to_a_region_of_every_joint() -> None:
    bank = Bank.of(ROBOT, ["viscous_friction: speed=0.5.."])
    (profile,) = bank.profiles
    assert on_joint(profile, "elbow_joint") == Region("elbow_joint", "speed", lower=0.5)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ((), "holds 1 to"),
        (["coulomb_friction", "coulomb_friction"], "twice"),
        (["payload"], "not an effect of one joint"),
        (["unknown"], "leave 'unknown' out"),
        (["coulomb_friction@elbow_joint"], "without a joint"),
        (["coulomb_friction: level=3"], "not given them"),
        (["sticktion"], "sticktion"),
        ([f"sin({k}*q)" for k in range(1, 14)], "holds 1 to"),
    ],
)
def test_an_impossible_bank_is_rejected_with_a_reason(asked, message) -> None:
    with pytest.raises(EffectError, match=message):
        Bank.of(ROBOT, asked)
