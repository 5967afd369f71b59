"""A load whose torque comes while a joint is in question already, and its numbers, which are refined afterwards."""

from dataclasses import replace

import numpy as np
import pytest
from made_logs import make

from cdia_pin.diagnosis import Monitor
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import parse_term
from cdia_pin.robot import load_robot

ARM = load_robot("ur5")
MASS = 2.5  # [kg]
LOAD = parse_term(f"payload: mass={MASS}, first_moment_x=0.05, first_moment_y=0.07, first_moment_z=0.15", ARM)
TAKEN = 8.0  # [s]
PUSH = np.array([0.0, 30.0, 30.0])  # [N]


def run(seed, *, loaded=False, pushed=()):
    """A run of an arm whose model is wrong by half a newton metre at each posture, that may take a load and be pushed.

    Args:
        seed: Of the motion.
        loaded: Whether it takes the load.
        pushed: From when to when it is pushed [s].
    """
    made = make(ARM, lambda q, v, a: 0.5 * np.sin(3.0 * q), seed=seed, duration=30.0, noise=0.2)
    carried, free = (Dynamics(ARM, terms).inverse_dynamics(made.q, made.v, made.a) for terms in ((LOAD,), ()))
    time, effort = made.log.time, made.log.effort.copy()
    effort[(time >= TAKEN) & loaded] += (carried - free)[(time >= TAKEN) & loaded]
    for k in np.flatnonzero((time >= pushed[0]) & (time < pushed[1])) if pushed else ():
        effort[k] -= ARM.link_end_jacobians(made.q[k])[-1][:3].T @ PUSH
    return replace(made.log, effort=effort)


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
