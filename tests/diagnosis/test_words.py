"""What would tell explanations apart follows from the signals that their formulas read."""

import pytest

from cdia_pin.diagnosis.words import signals_of, what_separates
from cdia_pin.effects import EFFECTS, Term

JOINT = "elbow_joint"


def term(name: str) -> Term:
    effect = EFFECTS[name](joint=JOINT)
    return Term(effect, (1.0,) * effect.size)


@pytest.mark.parametrize(
    ("name", "signals"),
    [
        ("coulomb_friction", {"v"}),
        ("viscous_friction", {"v"}),
        ("torque_offset", set()),
        ("joint_spring", {"q"}),
        ("position_ripple", {"q"}),
        ("actuator_gain", {"effort"}),
        ("load_friction", {"effort", "v"}),
        ("rotor_inertia", {"a"}),
    ],
)
def test_an_effect_reads_the_signals_of_its_formula(name: str, signals: set[str]) -> None:
    assert signals_of(EFFECTS[name](joint=JOINT)) == signals


def test_what_separates_names_both_and_the_motion() -> None:
    said = what_separates([[term("torque_offset")], [term("joint_spring")]])
    assert said.startswith("torque_offset and joint_spring explain this motion alike")
    assert said.endswith("reach other positions of the joint")


def test_a_combination_reads_what_any_of_its_effects_reads() -> None:
    said = what_separates([[term("actuator_gain"), term("coulomb_friction")], [term("coulomb_friction")]])
    assert "actuator_gain with coulomb_friction and coulomb_friction" in said
    assert said.endswith("load the joint differently")


def test_where_all_read_the_same_more_motion_is_advised() -> None:
    said = what_separates([[term("coulomb_friction")], [term("viscous_friction")]])
    assert "at several speeds, in both directions" in said
