"""Friction between two joints holds the sum of their speeds at rest at each reversal: that is no missing structure."""

import pytest

from benchmarks.plant import Fault
from cdia_pin import Dynamics, add_effect, discover
from cdia_pin.effects import CoupledFriction
from tests.hidden_plants import labels, plant_of

PAIRS = {"kinova": ("j2s6s200_joint_2", "j2s6s200_joint_3"), "z1": ("joint2", "joint3")}


@pytest.mark.parametrize("arm", PAIRS)
def test_friction_that_two_joints_share_explains_all_there_is(arm):
    plant, (joint, other) = plant_of(arm), PAIRS[arm]
    fault = Fault("coupled_friction", joint=joint, other=other, coefficient=1.0, level=1.4)
    log = plant.run([fault], seed=4).log
    found = discover(Dynamics(plant.robot), log)
    assert labels(found) == {f"coupled_friction@{joint}+{other}"}
    added = add_effect(Dynamics(plant.robot), CoupledFriction(joint, other), log)
    for answer in (found, added):
        assert answer.verdict == "explained"
        assert answer.steps[-1].term.theta == pytest.approx((1.0, 1.4), rel=0.03)
