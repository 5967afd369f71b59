"""Friction from run to run: what every arm shows is no change, and what one joint alone shows is."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from benchmarks.plant import Fault
from cdia_pin import Dynamics, load_robot, what_changed
from cdia_pin.changes.phenomenon import Phenomenon, PhenomenonKind
from cdia_pin.changes.run_to_run import NORMAL_95, RunToRun, UsualFriction, as_phenomena
from cdia_pin.effects import ActuatorGain, CoulombFriction, CoupledFriction, Payload, Term, TorqueOffset
from cdia_pin.selection.discovery_settings import RunToRunSettings
from tests.changes.test_changes import changed
from tests.hidden_plants import plant_of
from tests.made_logs import make

RULE = RunToRunSettings()


def arm(*growth, scales=None, visible_gain=0.1):
    """Friction, and scales of torques, of an arm whose joints differ by some shares."""
    n = len(growth)
    scales = np.full(n, np.nan) if scales is None else np.array(scales)
    names = tuple(f"joint{k}" for k in range(n))
    return RunToRun(
        names, np.ones(n), np.array(growth), scales, np.full(n, visible_gain), RULE, np.full(n, 0.5)
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


def test_the_interval_of_a_gain_allows_for_scales_that_differ():
    seen = Term(ActuatorGain("joint0"), (-0.2,)).with_intervals(np.array([0.01]))
    alone, steady, unsteady = (
        arm(*[np.nan] * 4, scales=[np.nan, *others]).allowed_for(seen, np.ones(4)).half_widths[0]
        for others in ([np.nan] * 3, [0.0] * 3, [0.03, -0.04, 0.03])
    )
    assert alone == pytest.approx(np.hypot(0.01, NORMAL_95 * RULE.scale * 0.8))
    assert 0.01 < steady < alone < unsteady


@pytest.mark.parametrize(("level", "named"), [(3.0, 0), (0.05, 1)])
def test_a_gain_of_a_joint_that_carries_little_is_a_change_of_its_friction(level, named):
    """Six percent less torque is usual where nearly all of it is friction, and is not where it carries links."""

    def log(name, seed, share):
        dry = partial(dry_friction, level)
        made = make(load_robot("double_pendulum"), dry, seed=seed, noise=0.003, duration=24.0)
        return replace(made.log, effort=made.log.effort * [1.0, share], source=name)

    found = what_changed(
        Dynamics(load_robot("double_pendulum")), log("a.csv", 5, 1.0), log("b.csv", 6, 1 / 1.06)
    )
    assert [c.term.label for c in found.changes] == ["actuator_gain@joint2"] * named
    assert len(found.usual) == 1 - named


def dry_friction(level, q, v, a):
    return np.column_stack([0 * q[:, 0], -level * np.tanh(v[:, 1] / 0.01)])


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
    (said,) = as_phenomena(found.usual, ())
    assert said.kind == "run-to-run"
    assert "no change" in said.sentence


def test_friction_that_the_temperature_explains_is_not_called_usual_besides():
    usual = [UsualFriction(j, (f"coulomb_friction@{j}",), 0.08, 0.15) for j in ("joint1", "joint2")]
    (both,) = as_phenomena(usual, ())
    assert both.joints == ("joint1", "joint2")
    colder = Phenomenon(PhenomenonKind.COOLING, ("joint1", "joint3"), "the drives are colder", {})
    (other,) = as_phenomena(usual, [colder])
    assert other.joints == ("joint2",)
    assert "joint1" not in other.sentence
    late = replace(colder, kind=PhenomenonKind.RECORDER)
    assert as_phenomena(usual, [late]) == (both,)
    assert as_phenomena(usual[:1], [colder]) == ()
