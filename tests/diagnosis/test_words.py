"""What the monitor says of explanations that it cannot tell apart."""

import pytest

from cdia_pin import load_robot
from cdia_pin.diagnosis.words import what_separates
from cdia_pin.effects import EFFECTS, Term

JOINT = "elbow_joint"


@pytest.fixture(scope="module")
def ur5():
    return load_robot("ur5")


def term(name: str) -> Term:
    effect = EFFECTS[name](joint=JOINT)
    return Term(effect, (1.0,) * effect.size)


def test_what_separates_names_both_and_the_motion(ur5) -> None:
    said = what_separates([[term("torque_offset")], [term("joint_spring")]], ur5)
    assert said.startswith("torque_offset and joint_spring explain this motion alike")
    assert "sweep the joint slowly over its whole range" in said


def test_combinations_are_named_as_they_are(ur5) -> None:
    said = what_separates(
        [[term("actuator_gain"), term("coulomb_friction")], [term("coulomb_friction")]], ur5
    )
    assert "actuator_gain with coulomb_friction and coulomb_friction" in said


def test_an_arm_without_a_fault_is_an_explanation_too(ur5) -> None:
    assert what_separates([[], [term("viscous_friction")]], ur5).startswith("none and viscous_friction")
