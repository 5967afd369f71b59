"""Effects hidden in a plant that is not our model are found by name; nothing is found where nothing is hidden.

Every effect and every combination is hidden in one of the arms, in turn; `python -m benchmarks.hidden_effects` hides
every effect in every arm, with every noise.
"""

import numpy as np
import pytest

from benchmarks.plant import scenarios
from tests.hidden_plants import hidden, label, labels, plant_of

ARMS = ("ur5", "panda")
# with a payload, on one joint, on two, one effect twice; the triples have the other effects
PAIRS = {0: "ur5", 1: "panda", 4: "panda", 6: "ur5", 8: "panda", 9: "panda"}
TRIPLES = (1, 2, 3, 4)


def in_turn(names):
    """Return arm and number of each scenario, the arms in turn; the plants are built when the tests run."""
    turns = [(ARMS[k % len(ARMS)], k, name) for k, name in enumerate(names)]
    return [pytest.param(arm, k, id=f"{arm}-{name}") for arm, k, name in turns]


def run(kind, arm, k):
    scenario = hidden(kind, arm)[k]
    return scenario, scenario.run(plant_of(arm))


def check(scenario, log_of_run, arm, discovered):
    found = discovered(arm, log_of_run.log)
    assert labels(found) == {label(f) for f in scenario.faults}
    assert found.verdict == "explained"
    last = found.trace[-1]
    assert (last.heldout_rms <= 1.2 * found.noise_floor).all(), last.heldout_rms / found.noise_floor
    return found


@pytest.mark.parametrize(("arm", "k"), in_turn(scenarios.RECIPES))
def test_a_single_effect_is_named_and_nothing_else(arm, k, discovered):
    scenario, done = run("singles", arm, k)
    found = check(scenario, done, arm, discovered)
    (fault,), (step,) = scenario.faults, found.steps
    for name, value in step.term.values.items():
        hidden = fault.parameters.get(name)
        if isinstance(hidden, float) and fault.effect not in {"link_inertia", "payload"}:
            assert value == pytest.approx(hidden, rel=0.05, abs=0.05 * max(map(abs, step.term.theta)))
    if fault.effect == "payload":
        assert step.term.values["mass"] == pytest.approx(fault.parameters["mass"], rel=0.02)


@pytest.mark.parametrize(("k", "arm"), PAIRS.items())
def test_pairs_on_one_joint_on_two_and_with_a_payload(arm, k, discovered):
    scenario, done = run("pairs", arm, k)
    check(scenario, done, arm, discovered)


@pytest.mark.parametrize("k", TRIPLES)
def test_three_at_once(k, discovered):
    scenario, done = run("triples", "ur5", k)
    check(scenario, done, "ur5", discovered)


@pytest.mark.parametrize("k", range(9))
def test_nothing_is_missing_from_a_clean_log(k, discovered):
    found = discovered("ur5", scenarios.clean()[k].run(plant_of("ur5")).log)
    assert found.verdict == "nothing-missing"
    assert labels(found) == set()


@pytest.mark.parametrize(
    ("arm", "k"),
    [
        case
        for case in in_turn(scenarios.OUTSIDE_RECIPES)
        # a drift and a memory, which are found: see test_recognition.py
        if "warming_friction" not in case.id and "presliding" not in case.id
    ],
)
def test_what_is_outside_the_vocabulary_is_called_unexplained(arm, k, discovered):
    scenario, done = run("outside", arm, k)
    found = discovered(arm, done.log)
    assert found.verdict == "unexplained"
    assert scenario.faults[0].joint in found.structure_left


def test_a_faulty_joint_is_found_on_another_motion_too(discovered):
    scenario = hidden("singles", "ur5")[0].holdout()
    found = discovered("ur5", scenario.run(plant_of("ur5")).log)
    assert labels(found) == {label(f) for f in scenario.faults}
    (level,) = found.steps[0].term.theta
    assert np.isclose(level, scenario.faults[0].parameters["level"], rtol=0.03)
