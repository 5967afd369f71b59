"""The result of a discovery: its JSON, its trace, and that it comes out the same each time."""

import json
from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, compare, discover, load_robot
from cdia_pin.changes.confidence import Confidence
from cdia_pin.discovery import DiscoveryVerdict
from cdia_pin.discovery.discovery_documents import FoundEffectJson
from cdia_pin.effects import CoulombFriction, Payload, Term, TorqueOffset
from cdia_pin.identifiability import Confusion
from cdia_pin.robot.inertia import parameters_of
from cdia_pin.selection import DiscoverySettings
from tests.made_logs import make

KEYS = {
    "capability",
    *(
        "schema",
        "robot",
        "joints",
        "verdict",
        "effects",
        "trace",
        "noise_floor",
        "torque_rms",
        "heldout_torque_rms",
        "compared_share",
    ),
    *("structure_left", "held", "resting", "ranking", "findings", "record"),
}


@pytest.fixture(scope="module")
def pendulum():
    return load_robot("double_pendulum")


def hidden(q, v, a):
    """Viscous friction on the first joint, quadratic friction on the second."""
    return np.column_stack([-0.2 * v[:, 0], -0.04 * np.abs(v[:, 1]) * v[:, 1]])


@pytest.fixture(scope="module")
def made(pendulum):
    return make(pendulum, hidden, noise=0.003, seed=1, duration=30.0)


@pytest.fixture(scope="module")
def found(pendulum, made):
    return discover(Dynamics(pendulum), made.log)


@pytest.fixture(scope="module")
def loaded(pendulum):
    """A discovery whose effect belongs to the whole arm: a load of 100 g."""
    body = parameters_of(0.1, [0.0, 0.0, 0.05], 1e-4 * np.eye(3))
    true = Dynamics(pendulum, (Term(Payload(), tuple(body)),))
    made = make(pendulum, seed=2, duration=30.0)
    noise = 0.003 * np.random.default_rng(0).standard_normal(made.q.shape)
    effort = true.inverse_dynamics(made.q, made.v, made.a) + noise
    return discover(Dynamics(pendulum), replace(made.log, effort=effort))


def test_the_json_has_the_keys_of_its_schema(pendulum, found):
    out = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert set(out) == KEYS
    assert out["schema"] == "cdia-discovery/1"
    assert out["robot"] == pendulum.name
    assert out["joints"] == list(pendulum.joints)
    assert out["verdict"] == "explained"
    assert list(out["noise_floor"]) == list(pendulum.joints)
    assert [e["effect"] for e in out["effects"]] == [s.term.effect.name for s in found.steps]
    for entry in out["effects"]:
        assert set(entry) - {"shape"} == {
            *("effect", "joints", "parameters", "confusable_with"),
            *("confidence", "group", "change_of_model"),
        }
        assert entry["confidence"] in set(Confidence)
        for parameter in entry["parameters"].values():
            assert set(parameter) == {"value", "unit", "ci95", "ci95_statistical"}
            low, high = parameter["ci95"]
            inner = parameter["ci95_statistical"]
            assert low <= inner[0] <= parameter["value"] <= inner[1] <= high
        for other in entry["confusable_with"]:
            assert set(other) == {"effect", "joints", "motion"}


def test_what_is_found_is_written_by_name_joint_and_unit(found):
    entries = {(e["effect"], *e["joints"]): e["parameters"] for e in found.to_dict()["effects"]}
    assert set(entries) == {("viscous_friction", "joint1"), ("quadratic_friction", "joint2")}
    assert entries["viscous_friction", "joint1"]["coefficient"]["unit"] == "N·m·s/rad"
    assert entries["viscous_friction", "joint1"]["coefficient"]["value"] == pytest.approx(0.2, rel=0.03)
    assert entries["quadratic_friction", "joint2"]["coefficient"]["unit"] == "N·m·s²/rad²"
    assert entries["quadratic_friction", "joint2"]["coefficient"]["value"] == pytest.approx(0.04, rel=0.03)


def test_the_trace_begins_with_the_model_as_given_and_adds_one_effect_a_step(pendulum, found):
    trace = found.to_dict()["trace"]
    assert [t["added"] for t in trace] == [None, *(s.term.label for s in found.steps)]
    for step in trace:
        assert set(step) == {"added", "rms", "heldout_rms"}
        assert list(step["rms"]) == list(step["heldout_rms"]) == list(pendulum.joints)


def test_the_ends_of_the_trace_are_the_errors_of_the_models(pendulum, made, found):
    before, after = compare(Dynamics(pendulum), made.log), compare(found.model, made.log)
    np.testing.assert_allclose(found.trace[0].rms, before.rms, rtol=1e-6)
    np.testing.assert_allclose(found.trace[-1].rms, after.rms, rtol=1e-3)
    np.testing.assert_allclose(found.trace[0].heldout_rms, found.trace[0].rms)


def test_every_step_lowers_the_error_of_the_joint_it_acts_on(pendulum, found):
    for before, after in zip(found.trace[:-1], found.trace[1:], strict=True):
        joints = list(after.term.effect.acts_on(pendulum))
        assert (after.heldout_rms[joints] < 0.9 * before.heldout_rms[joints]).any()
    assert (found.trace[-1].heldout_rms <= 1.15 * found.noise_floor).all()


def test_the_strongest_effect_is_added_first(found):
    assert found.steps[0].term.label == "viscous_friction@joint1"


def test_held_out_logs_are_only_predicted(pendulum, made):
    other = make(pendulum, hidden, noise=0.003, seed=5, duration=20.0)
    found = discover(Dynamics(pendulum), made.log, holdout=other.log)
    np.testing.assert_allclose(found.trace[-1].heldout_rms, compare(found.model, other.log).rms, rtol=0.05)
    assert len(found.record["holdout"]) == 1
    assert (found.trace[-1].heldout_rms < 1.5 * found.noise_floor).all()


def test_an_effect_of_the_whole_arm_lists_every_joint(pendulum, loaded):
    (entry,) = loaded.to_dict()["effects"]
    assert entry["effect"] == "payload"
    assert entry["joints"] == list(pendulum.joints)
    assert entry["parameters"]["mass"]["unit"] == "kg"
    assert list(entry["parameters"]) == [p.name for p in Payload().parameters]


def test_a_confusion_with_one_effect_names_it_and_its_joint(pendulum, loaded):
    others = {(o["effect"], *o["joints"]): o["motion"] for o in _confusable(loaded)}
    assert "no motion" in others["link_inertia", "joint2"]


def _confusable(found):
    return [o for e in found.to_dict()["effects"] for o in e["confusable_with"]]


def test_a_confusion_with_two_effects_names_both_with_their_joints(found):
    two = Confusion((CoulombFriction("joint1"), TorqueOffset("joint2")), "move")
    last = replace(found.trace[-1], confusions=(two,))
    out = replace(found, trace=(*found.trace[:-1], last)).to_dict()["effects"][-1]["confusable_with"]
    assert out == [
        {
            "effect": "coulomb_friction@joint1 + torque_offset@joint2",
            "joints": ["joint1", "joint2"],
            "motion": "move",
        }
    ]


def test_nothing_hidden_is_a_verdict_of_its_own(pendulum):
    found = discover(Dynamics(pendulum), make(pendulum, noise=0.003, seed=3).log)
    out = found.to_dict()
    assert out["verdict"] == "nothing-missing"
    assert out["effects"] == []
    assert [t["added"] for t in out["trace"]] == [None]


def test_verdicts_are_four():
    assert set(DiscoveryVerdict) == {"nothing-missing", "explained", "explained-in-practice", "unexplained"}


def test_the_same_log_gives_the_same_json(pendulum, made, found):
    again = discover(Dynamics(pendulum), made.log)
    assert json.dumps(again.to_dict()) == json.dumps(found.to_dict())


def test_the_order_of_two_logs_does_not_matter(pendulum, made):
    other = make(pendulum, hidden, noise=0.003, seed=5, duration=20.0)
    one, two = (discover(Dynamics(pendulum), logs) for logs in ([made.log, other.log], [other.log, made.log]))
    first, second = ({s.term.label: s.term.theta for s in d.steps} for d in (one, two))
    assert set(first) == set(second)
    for label, theta in first.items():
        np.testing.assert_allclose(theta, second[label], rtol=0.01)


def test_the_given_model_is_not_changed(pendulum, made):
    model = Dynamics(pendulum)
    discover(model, made.log)
    assert model.terms == ()


def test_the_record_is_enough_to_run_it_again(made, found):
    record = found.to_dict()["record"]
    assert record["version"]
    assert record["blocks"] == DiscoverySettings().blocks
    (log,) = record["logs"]
    assert {"source", "sha256", "cutoff", "trim", "compared_rate"} <= set(log)
    assert log["source"] == made.log.source


def test_only_the_effects_asked_for_are_searched(pendulum, made):
    settings = DiscoverySettings(effects=("viscous_friction", "torque_offset"))
    found = discover(Dynamics(pendulum), made.log, settings=settings)
    assert {s.term.effect.name for s in found.steps} <= {"viscous_friction", "torque_offset"}
    assert "viscous_friction@joint1" in {s.term.label for s in found.steps}
    assert found.verdict == "unexplained"
    assert found.structure_left == ("joint2",)
    assert found.record["effects"] == ["viscous_friction", "torque_offset"]


def test_the_ranking_names_what_was_found_and_what_it_would_do_alone(found):
    labels = [r.term.label for r in found.ranking]
    assert len(set(labels)) == len(labels)
    assert {s.term.label for s in found.steps} <= set(labels)
    best = found.ranking[0]
    assert (best.heldout_after <= best.heldout_before * 1.01).all()
    for entry in found.to_dict()["ranking"]:
        assert set(entry["heldout_rms"]) == {"before", "after"}
        assert set(entry) - set(FoundEffectJson.__annotations__) == {"heldout_rms"}


def test_progress_goes_from_none_to_all(pendulum, made):
    told = []
    discover(Dynamics(pendulum), made.log, progress=lambda sentence, share: told.append((sentence, share)))
    shares = [s for _, s in told]
    assert shares[0] == 0.0
    assert shares[-1] == 1.0
    assert all(0.0 <= s <= 1.0 for s in shares)
    assert shares == sorted(shares)
    assert all(isinstance(s, str) and s for s, _ in told)


def test_the_ranking_starts_with_the_step_taken_and_goes_on_by_error(found):
    first, *others = found.ranking
    assert first.term.label == found.steps[0].term.label
    left = [float(np.mean(r.heldout_after / found.torque_rms)) for r in others]
    assert left == sorted(left)


def test_no_candidate_of_the_ranking_sits_at_a_bound(found):
    robot = found.model.robot
    for r in found.ranking:
        lower, upper = r.term.effect.bounds(robot)
        assert (np.array(r.term.theta) > lower).all(), r.term
        assert (np.array(r.term.theta) < upper).all(), r.term
