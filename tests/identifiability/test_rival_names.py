"""A name is not established where another effect explains the logs as well and says something else of the arm."""

import pytest

from cdia_pin.effects import Term, parse_effect
from cdia_pin.identifiability.confusion import Confusion
from cdia_pin.identifiability.rival_names import has_another_name


@pytest.mark.parametrize(
    ("named", "rival", "doubtful"),
    [
        ("coulomb_friction@elbow_joint", "torque_offset@wrist_1_joint", False),
        ("coulomb_friction@elbow_joint", "torque_offset@elbow_joint", True),
        ("coulomb_friction@elbow_joint", "presliding_friction@elbow_joint", False),
        ("coulomb_friction@elbow_joint", "viscous_friction@elbow_joint", True),
        ("viscous_friction@elbow_joint", "coulomb_friction@elbow_joint", True),
        ("viscous_friction@elbow_joint", "actuator_gain@elbow_joint", False),
        ("torque_offset@elbow_joint", "joint_spring@elbow_joint", False),
        ("torque_offset@elbow_joint", "joint_spring@wrist_1_joint", True),
        ("asymmetric_friction@elbow_joint", "coulomb_friction@elbow_joint", True),
        ("torque_offset@elbow_joint", "actuator_gain@elbow_joint", True),
        ("payload", "link_inertia@wrist_3_joint", False),
        ("link_inertia@elbow_joint", "link_inertia@wrist_1_joint", True),
    ],
)
def test_what_every_joint_has_and_a_finer_drawing_have_no_other_name(ur5, named, rival, doubtful):
    effect, other = (parse_effect(text, ur5) for text in (named, rival))
    term = Term(effect, (1.0,) * effect.size)
    assert has_another_name(term, [Confusion((other,), "")], ur5) is doubtful


def test_several_effects_together_are_another_name(ur5):
    two = tuple(parse_effect(f"{kind}_friction@elbow_joint", ur5) for kind in ("coulomb", "viscous"))
    effect = parse_effect("stribeck_friction@elbow_joint", ur5)
    term = Term(effect, (1.0,) * effect.size)
    assert has_another_name(term, [Confusion(two, "")], ur5)
    assert not has_another_name(term, [], ur5)
