"""A load whose torque comes while a joint is in question already, and its numbers, which are refined afterwards."""

from dataclasses import replace

import numpy as np
import pytest
from loaded_arms import ARM, MASS, loaded_run

from cdia_pin.diagnosis import Monitor
from cdia_pin.dynamics import Dynamics

TAKEN = 8.0  # [s]
PUSH = np.array([0.0, 30.0, 30.0])  # [N]
NEVER = (np.inf, np.inf)  # [s]


def run(seed, *, loaded=False, pushed=NEVER):
    """A run of an arm that may take the load, and be pushed from some time to another [s]."""
    made, log = loaded_run(seed, (TAKEN, np.inf) if loaded else NEVER, duration=30.0)
    effort = log.effort.copy()
    for k in np.flatnonzero((log.time >= pushed[0]) & (log.time < pushed[1])):
        effort[k] -= ARM.link_end_jacobians(made.q[k])[-1][:3].T @ PUSH
    return replace(log, effort=effort)


@pytest.fixture(scope="module")
def monitor():
    return Monitor(Dynamics(ARM), healthy=[run(1)])


@pytest.mark.parametrize("seed", [2, 3, 4])
def test_the_interval_of_a_mass_narrows_while_its_load_is_on_trial(monitor, seed):
    found = []
    monitor.replay(
        run(seed, loaded=True), lambda s: found.extend(t for t in s.faults if t.label == "payload")
    )
    first, last = found[0], found[-1]
    assert last.half_widths[0] < 0.7 * first.half_widths[0]
    assert abs(last.theta[0] - MASS) < last.half_widths[0]


@pytest.mark.parametrize("seed", [7, 20, 27])
def test_a_load_is_named_though_a_joint_was_in_question_before(monitor, seed):
    """Before, samples from before the load hid it, and up to eight names of joints stood in its place."""
    before, ever = [], set()

    def see(status):
        if status.time < TAKEN:
            before.append([str(stage) for stage in status.stages])
        ever.update(t.label for t in status.faults if t.effect.name != "external_wrench")

    monitor.replay(run(seed, loaded=True), see)
    assert "detected" in before[-1], "no joint is in question, so that this shows nothing"
    assert ever == {"payload"}


@pytest.mark.parametrize("seed", [7, 402])
def test_a_load_is_no_hand_once_it_is_named(monitor, seed):
    """Before, its formula was off by more than a healthy arm is, and contact was said."""
    events = monitor.replay(run(seed, loaded=True))
    named = next(e.time for e in events if any(t.label == "payload" for t in e.faults))
    later = {t.label for e in events if e.time > named + 0.5 for t in e.faults}
    assert not {label for label in later if label.startswith("external_wrench")}


@pytest.mark.parametrize("begin", [11.0, 12.3, 14.6])
def test_a_push_is_said_while_a_load_is_on_trial(monitor, begin):
    events = monitor.replay(run(2, loaded=True, pushed=(begin, begin + 1.0)))
    said = [e.time for e in events for t in e.faults if t.label.startswith("external_wrench@")]
    assert any(begin < time < begin + 0.3 for time in said)
