"""Friction from run to run: what every arm shows is no change, and what one joint alone shows is."""

import numpy as np
import pytest

from benchmarks.plant import Fault
from cdia_pin.changes.run_to_run import NORMAL_95, RunToRun, as_phenomena
from cdia_pin.effects import CoulombFriction, CoupledFriction, Payload, Term, TorqueOffset
from cdia_pin.selection.discovery_settings import RunToRunSettings
from tests.changes.test_changes import changed
from tests.hidden_plants import plant_of

RULE = RunToRunSettings()


def arm(*growth):
    """Friction of an arm whose joints differ by some shares."""
    return RunToRun(
        tuple(f"joint{k}" for k in range(len(growth))), np.ones(len(growth)), np.array(growth), RULE
    )


def test_alone_a_joint_may_differ_by_what_is_known_beforehand():
    assert arm(0.3).limit(0) == pytest.approx(RULE.deviations * RULE.spread)
    assert arm(0.3, np.nan, np.nan).limit(0) == pytest.approx(RULE.deviations * RULE.spread)


def test_quiet_neighbours_lower_the_limit_and_unsteady_ones_raise_it():
    assert arm(0.1, 0.0, 0.0, 0.0, 0.0, 0.0).limit(0) < arm(0.1).limit(0)
    assert arm(0.1, 0.06, 0.06, 0.06, 0.06, 0.06).limit(0) > arm(0.1).limit(0)


def test_one_worn_neighbour_does_not_hide_another_joint():
    quiet, worn = arm(0.1, 0.0, 0.01, 0.01, 0.0, 0.01), arm(0.1, 0.0, 0.01, 0.01, 0.0, 0.9)
    assert worn.limit(0) == pytest.approx(quiet.limit(0), rel=0.05)


def test_a_joint_has_no_say_in_its_own_limit_and_no_limit_is_boundless():
    assert arm(0.01, 0.02, 0.02).limit(0) == arm(5.0, 0.02, 0.02).limit(0)
    assert arm(5.0, 5.0, 5.0).limit(0) == pytest.approx(RULE.deviations * RULE.largest_spread)


def test_the_size_of_a_change_of_friction_allows_for_what_is_usual():
    seen = Term(CoulombFriction("joint0"), (2.0,)).with_intervals(np.array([0.1]))
    twice_the_friction, none_elsewhere = np.array([2.0, 0.0]), arm(0.0, np.nan)
    found = none_elsewhere.allowed_for(seen, twice_the_friction)
    assert found.ci95_statistical == seen.ci95
    assert found.half_widths == pytest.approx(np.hypot(0.1, NORMAL_95 * RULE.spread / 2 * 2.0))
    larger = none_elsewhere.allowed_for(seen, 10 * twice_the_friction)
    assert larger.half_widths == pytest.approx(0.1, rel=0.01)


def test_the_usual_difference_of_two_joints_counts_for_friction_between_them():
    seen = Term(CoupledFriction("joint0", "joint1"), (1.0, 0.0)).with_intervals(np.zeros(2))
    found = arm(np.nan, np.nan).allowed_for(seen, np.ones(2))
    np.testing.assert_allclose(found.half_widths, [NORMAL_95 * RULE.spread, 0.0])


@pytest.mark.parametrize("effect", [Payload(), TorqueOffset("joint0")])
def test_what_is_no_friction_differs_by_nothing_from_run_to_run(effect):
    seen = Term(effect, (1.0,) * effect.size).with_intervals(np.full(effect.size, 0.1))
    assert arm(0.1, 0.1).allowed_for(seen, np.ones(2)) == seen


def friction(*growth):
    """Coulomb friction of all joints of a UR5, each with its growth [1]."""
    levels = (6.0, 12.0, 6.0, 0.8, 0.8, 0.6)  # [N·m], enough for a few percent to be seen
    pairs = zip(plant_of("ur5").joints, levels, growth, strict=True)
    return tuple(Fault("coulomb_friction", joint=j, level=x * (1 + g)) for j, x, g in pairs)


def test_friction_between_two_joints_is_no_change_where_it_is_no_more_than_is_usual():
    before = friction(*[0.0] * 6)
    for level, named in ((0.15, 0), (0.4, 1)):
        between = Fault("coupled_friction", joint="elbow_joint", other="wrist_1_joint", level=level)
        assert len(changed(before, (*before, between)).changes) == named


def test_friction_of_all_joints_that_differs_a_little_is_no_change_and_wear_is():
    plant = plant_of("ur5")
    drift = (0.05, 0.06, -0.05, 0.06, 0.05, 0.05)
    worn = (*drift[:2], 0.6, *drift[3:])
    found = changed(friction(*[0.0] * 6), friction(*worn))
    (change,) = found.changes
    assert change.term.label == "coulomb_friction@elbow_joint"
    assert change.term.values["level"] == pytest.approx(0.6 * 6.0, rel=0.06)
    assert {u.joint for u in found.usual} <= {*plant.joints} - {"elbow_joint"}
    assert all(0.02 < u.share <= u.limit for u in found.usual)
    assert found.usual
    assert {u["joint"] for u in found.to_dict()["usual_friction"]} == {u.joint for u in found.usual}
    (said,) = as_phenomena(found.usual)
    assert said.kind == "run-to-run"
    assert "no change" in said.sentence
