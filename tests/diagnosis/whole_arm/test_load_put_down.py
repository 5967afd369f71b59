"""A load that an arm takes and puts down again: the arm is as it was, and joints decide on what they show since."""

from dataclasses import replace

import numpy as np
import pytest
from loaded_arms import ARM, loaded_run

from cdia_pin.diagnosis import Monitor
from cdia_pin.dynamics import Dynamics

WRIST = ARM.joint_index("wrist_1_joint")
FRICTION = 1.5  # [N·m]


def run(seed, *loaded, friction_from=np.inf):
    """A run of an arm with a load at some times [s], and with friction from some time on."""
    made, log = loaded_run(seed, *loaded, duration=45.0)
    effort, rubs = log.effort.copy(), log.time >= friction_from
    effort[rubs, WRIST] += FRICTION * np.sign(made.v[rubs, WRIST])
    return replace(log, effort=effort)


@pytest.fixture(scope="module")
def monitor():
    return Monitor(Dynamics(ARM), healthy=[run(1)])


def times_of(monitor, log, label):
    """Time with a fault of a label, and labels of all others, contact left out."""
    seen, others = [], set()

    def see(status):
        labels = {t.label for t in status.faults if t.effect.name != "external_wrench"}
        seen.append(label in labels)
        others.update(labels - {label})

    monitor.reset()
    monitor.replay(log, see)
    return np.array(seen), others, [t.label for t in monitor.faults]


@pytest.mark.parametrize("seed", [2, 3, 4])
def test_a_load_that_was_put_down_is_gone_and_leaves_no_names_of_joints(monitor, seed):
    log = run(seed, (8.0, 25.0))
    there, others, left = times_of(monitor, log, "payload")
    assert others == set()
    assert left == []
    after = log.time >= 25.0
    assert there[(log.time > 12.0) & ~after].all()
    assert not there[log.time > 28.0].any()


@pytest.mark.parametrize("seed", [2, 3, 4])
def test_a_load_that_is_put_down_soon_is_gone_as_soon(monitor, seed):
    """Before, samples with the load counted as if it were still asked for, and the arm carried it for seconds more."""
    log = run(seed, (8.0, 14.0), (20.0, 26.0))
    there, others, left = times_of(monitor, log, "payload")
    assert others == set()
    assert left == []
    for end in (14.0, 26.0):
        assert np.mean(there[(log.time >= end) & (log.time < end + 5.0)]) < 0.5


@pytest.mark.parametrize("seed", [2, 3, 4])
def test_friction_that_was_known_before_stays_that_friction(monitor, seed):
    """Before, the wrist decided on samples from while the load was not known yet, and named others in its place."""
    _, others, left = times_of(
        monitor, run(seed, (18.0, 30.0), friction_from=6.0), "coulomb_friction@wrist_1_joint"
    )
    assert others == {"payload"}
    assert left == ["coulomb_friction@wrist_1_joint"]
