"""A later log against a model: what is new, what changed in the model, and what stayed; plants are MuJoCo's."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.plant import Fault
from cdia_pin import Dynamics, discover, load_model, load_robot, save_model
from cdia_pin.changes.detection import searched
from cdia_pin.discovery.beyond_model import updated
from cdia_pin.effects import parse_term
from cdia_pin.logs.conditioning import condition
from cdia_pin.selection import DiscoverySettings
from tests.changes.test_conditions import pair
from tests.hidden_plants import plant_of
from tests.made_logs import make

SECONDS = 24.0
ELBOW = {"joint": "elbow_joint"}
KNOWN = (Fault("coulomb_friction", level=3.0, **ELBOW), Fault("viscous_friction", coefficient=2.0, **ELBOW))
GROWN = (Fault("coulomb_friction", level=4.5, **ELBOW), KNOWN[1])


def run(faults, seed):
    return plant_of("ur5").run(faults, duration=SECONDS, seed=seed).log


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    """A model that was learned from a log, saved and loaded again."""
    robot = plant_of("ur5").robot
    found = discover(Dynamics(robot), run(KNOWN, 3))
    return load_model(save_model(found.model, tmp_path_factory.mktemp("model") / "base.json"), robot)


def test_a_loaded_model_remembers_the_motion_it_was_learned_from(base):
    assert [m.joints for m in base.learned_from] == [base.robot.joints]
    assert base.add(base.terms[0]).learned_from == base.learned_from


def test_friction_that_grew_is_a_change_of_the_model(base):
    found = discover(base, run(GROWN, 1003))
    (step,) = found.steps
    assert (step.term.label, step.change_of_model) == ("coulomb_friction@elbow_joint", True)
    assert step.term.theta[0] == pytest.approx(1.5, rel=0.05)
    grown = found.model.find(step.term.label)
    assert grown.theta[0] == pytest.approx(4.5, rel=0.03)
    for low, high in (*grown.ci95, *(grown.ci95_statistical or ())):  # around the new value, not the old one
        assert low < grown.theta[0] < high
    assert found.to_dict()["effects"][0]["change_of_model"] is True


def test_what_did_not_change_keeps_its_value(base):
    found = discover(base, run(GROWN, 1003))
    label = "viscous_friction@elbow_joint"
    assert found.model.find(label).theta == base.find(label).theta


def test_a_parameter_that_is_updated_again_and_again_does_not_become_less_certain():
    """Each log tells it to ±0.1, and its difference to the last log to ±0.14."""
    robot = load_robot("ur5")
    term = parse_term("coulomb_friction@elbow_joint: level=3", robot)
    model = Dynamics(robot, (term.with_intervals(np.array([0.1])),))
    for _ in range(6):
        model = updated(model, term.with_theta([0.1]).with_intervals(np.array([0.14])))
    (grown,) = model.terms
    assert grown.theta[0] == pytest.approx(3.6)
    np.testing.assert_allclose(grown.half_widths, 0.14)


def test_friction_that_falls_by_more_than_there_was_is_gone():
    robot = load_robot("ur5")
    term = parse_term("coulomb_friction@elbow_joint: level=1", robot).with_intervals(np.array([0.1]))
    (left,) = updated(Dynamics(robot, (term,)), term.with_theta([-1.4]).with_intervals(np.array([0.2]))).terms
    assert left.theta == (0.0,)
    np.testing.assert_allclose(left.half_widths, 0.2)


def test_a_new_effect_is_no_change_of_the_model(base):
    spring = Fault("joint_spring", joint="wrist_1_joint", stiffness=1.5, preload=0.5)
    found = discover(base, run((*KNOWN, spring), 1003))
    (step,) = found.steps
    assert (step.term.label, step.change_of_model) == ("joint_spring@wrist_1_joint", False)


def test_nothing_changed_means_nothing_is_moved(base):
    found = discover(base, run(KNOWN, 1003))
    assert (found.verdict, found.steps) == ("nothing-missing", ())
    assert found.model.terms == base.terms


def test_the_log_of_the_model_itself_is_searched_as_before(base):
    found = discover(base, run(KNOWN, 3))
    assert found.steps == ()
    assert np.allclose(found.model.terms[0].theta, base.terms[0].theta, rtol=0.05)


def test_an_unusual_effect_that_only_describes_its_log_is_no_candidate_for_a_change(base):
    robot, settings = base.robot, DiscoverySettings()
    model = base.add(parse_term("tool_wrench: force_z=-2"))
    later = condition(run(KNOWN, 1003), robot, settings.searched)
    for expected in ((), ("tool_wrench",)):
        found = searched(model, model.learned_from, [later], replace(settings, expected=expected))
        names = {e.effect.name for e in found.search.evidence.effects}
        assert "payload" in names
        assert ("tool_wrench" in names) is bool(expected)


@pytest.mark.parametrize(("name", "grown"), [("new.csv", 0.05), ("log2.csv", 0.0)])
def test_a_model_with_parameters_per_log_knows_its_own_logs(name, grown):
    robot = load_robot("double_pendulum")
    model = discover(Dynamics(robot), pair(robot, 0.1, 0.2)).model  # 0.15 in a log of no known name

    def missing(q, v, a):
        return np.column_stack([-0.2 * v[:, 0], -0.05 * np.tanh(v[:, 1] / 1e-3)])

    found = discover(model, replace(make(robot, missing, seed=9, noise=0.004).log, source=name))
    sizes = {s.term.label: s.term.theta[0] for s in found.steps}
    assert sizes == ({"viscous_friction@joint1": pytest.approx(grown, rel=0.05)} if grown else {})
