"""A URDF that is a little wrong everywhere, beside a hidden effect, on an arm in MuJoCo."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.hidden_effects.cases import planned
from benchmarks.hidden_effects.drawing import drawn, recorded
from benchmarks.hidden_effects.oracle import noise_floor
from benchmarks.hidden_effects.truth import true_model
from cdia_pin import Dynamics
from cdia_pin.discovery import compare, discover
from cdia_pin.effects import LinkInertias
from cdia_pin.identification import identify
from cdia_pin.selection import DiscoverySettings
from cdia_pin.selection.every_link import possible_links

CASE = "ur5/model error/torque_offset 20%/quantised/good/3"


@pytest.fixture(scope="module")
def case():
    return next(c for c in planned() if c.id == CASE)


@pytest.fixture(scope="module")
def plant_and_log(case):
    plant, scenario = drawn(case)
    return plant, scenario, recorded(case, scenario.run(plant))


@pytest.fixture(scope="module")
def found(plant_and_log):
    plant, _, log = plant_and_log
    return discover(Dynamics(plant.robot), log)


def test_many_small_errors_of_links_are_one_effect(plant_and_log, found):
    plant, *_ = plant_and_log
    every = LinkInertias(plant.robot.joints)
    assert {s.term.label for s in found.steps} == {"torque_offset@shoulder_pan_joint", every.label}
    assert found.verdict == "explained"
    term = found.model.find(every.label)
    assert term.effect.is_physical(np.array(term.theta), plant.robot)


def test_another_motion_is_predicted_nearly_as_by_the_truth(case, plant_and_log, found):
    plant, scenario, _ = plant_and_log
    later = recorded(case, replace(scenario.holdout(), duration=18.0).run(plant))
    floor = noise_floor(true_model(plant, scenario.faults), later)
    assert np.sqrt(np.mean((compare(found.model, later).rms / floor) ** 2)) < 1.03


def test_a_link_that_is_no_possible_body_is_not_slightly_wrong(plant_and_log):
    plant, *_ = plant_and_log
    bodies = plant.robot.inertial_parameters.copy()
    bodies[2, 4] *= 100.0  # one principal moment above the sum of the others
    links = possible_links(plant.robot.with_inertial_parameters(bodies))
    assert links.links == tuple(j for k, j in enumerate(plant.robot.joints) if k != 2)


def test_who_asks_for_other_effects_gets_no_others(plant_and_log):
    plant, _, log = plant_and_log
    asked = DiscoverySettings(effects=("torque_offset",))
    found = discover(Dynamics(plant.robot), log, settings=asked)
    assert [s.term.label for s in found.steps] == ["torque_offset@shoulder_pan_joint"]


def test_an_identification_goes_on_from_there_link_by_link(plant_and_log, found):
    plant, _, log = plant_and_log
    identified = identify(found.model, log)
    labels = [t.label for t in identified.bodies]
    assert labels == [f"link_inertia@{j}" for j in plant.robot.joints]
    assert identified.heldout_after.mean() < 1.05 * found.trace[-1].heldout_rms.mean()
