"""Torques that are recorded late on one side: one delay, however large, and no other change."""

import dataclasses

import numpy as np
import pytest

from benchmarks.plant import Fault
from cdia_pin import Dynamics, discover, what_changed
from tests.changes.test_changes import SECONDS, WRONG, the_only
from tests.hidden_plants import plant_of

PAYLOAD = Fault("payload", mass=2.0, com=(0.0, 0.0, 0.05))


def recorded_late(log, delay):
    """Return a log whose torques are late [s], as a recorder that holds them back writes them."""
    late = [np.interp(log.time - delay, log.time, column) for column in log.effort.T]
    return dataclasses.replace(log, effort=np.column_stack(late))


def changed(delay, faults=()):
    """What changed between two logs of different motions, the torques of the later one being late by a delay [s]."""
    plant = plant_of("ur5")
    before = plant.run(WRONG, duration=SECONDS, seed=3).log
    after = plant.run((*WRONG, *faults), duration=SECONDS, seed=1003).log
    return what_changed(Dynamics(plant.robot), before, recorded_late(after, delay))


@pytest.mark.parametrize("delay", [0.02, 0.08])
def test_a_log_after_a_late_one_is_early(delay):
    plant = plant_of("ur5")
    before, after = (plant.run(WRONG, duration=SECONDS, seed=seed).log for seed in (3, 1003))
    found = what_changed(Dynamics(plant.robot), recorded_late(before, delay), after)
    term = the_only(found).term
    assert term.label == "effort_delay"
    assert term.theta[0] == pytest.approx(-delay, abs=3e-3)


@pytest.mark.parametrize("delay", [0.09, -0.06])
def test_a_long_delay_is_the_only_change(delay):
    found = changed(delay)
    term = the_only(found).term
    assert term.label == "effort_delay"
    assert term.theta[0] == pytest.approx(delay, abs=3e-3)
    assert [f.kind for f in found.findings] == ["recorder"]


def test_a_payload_is_weighed_though_its_log_is_late():
    terms = {c.term.label: c.term for c in changed(0.08, (PAYLOAD,)).changes}
    assert terms.keys() == {"effort_delay", "payload"}
    assert terms["payload"].values["mass"] == pytest.approx(2.0, rel=0.1)


def test_a_model_says_of_a_late_log_that_it_is_late():
    plant = plant_of("ur5")
    robot, before = plant.robot, plant.run((), duration=SECONDS, seed=3).log
    known = discover(Dynamics(robot), before).model
    after = recorded_late(plant.run((), duration=SECONDS, seed=1003).log, 0.08)
    found = discover(known, after)
    assert [step.term.label for step in found.steps] == ["effort_delay"]
    assert np.mean(found.trace[-1].heldout_rms / found.torque_rms) < 0.2 * np.mean(
        found.trace[0].heldout_rms / found.torque_rms
    )
