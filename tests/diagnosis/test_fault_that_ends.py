"""A fault that ends is cleared, also one whose torque is less than twice the threshold of its joint."""

from dataclasses import replace

import numpy as np
import pytest
from made_logs import make

from cdia_pin.diagnosis import Monitor, replay
from cdia_pin.dynamics import Dynamics
from cdia_pin.robot import load_robot

ARM = load_robot("ur5")
JOINT = "elbow_joint"
ELBOW = ARM.joint_index(JOINT)
ON_THE_ELBOW = np.eye(ARM.n)[ELBOW]
BEGIN, END = 12.0, 28.0  # [s], of the fault
VISCOUS, OFFSET = 6.0, 5.0  # [N·m·s/rad] and [N·m], less than the threshold of 7.6 N·m at most speeds


def run(seed, offset=0.0, viscous=0.0, end=END):
    """A run of an elbow whose model is wrong by 2 N·m at each posture, so that its threshold is wide."""
    made = make(
        ARM, lambda q, v, a: 2.0 * np.sin(3.0 * q) * ON_THE_ELBOW, seed=seed, duration=45.0, noise=0.5
    )
    on = (made.log.time > BEGIN) & (made.log.time < end)
    fault = on * (offset + viscous * made.v[:, ELBOW])
    return replace(made.log, effort=made.log.effort + np.outer(fault, ON_THE_ELBOW), source=f"run {seed}")


@pytest.fixture(scope="module")
def monitor():
    return Monitor(Dynamics(ARM), healthy=[run(1)])


@pytest.mark.parametrize("seed", [2, 3, 4])
@pytest.mark.parametrize("fault", [{"offset": OFFSET}, {"viscous": VISCOUS}], ids=["offset", "viscous"])
def test_a_fault_that_ends_is_cleared_and_no_other_stays(monitor, seed, fault):
    """Before, a second fault was named that cancels the first, or the first stayed with a part of its size."""
    found = replay(monitor, run(seed, **fault))
    assert {e.joints for e in found.events} == {(JOINT,)}
    assert found.events[-1].stage == "idle"
    assert not found.faults


@pytest.mark.parametrize("seed", [2, 3, 4])
@pytest.mark.parametrize("fault", [{"offset": OFFSET}, {"viscous": VISCOUS}], ids=["offset", "viscous"])
def test_a_fault_that_stays_is_not_cleared(monitor, seed, fault):
    found = replay(monitor, run(seed, **fault, end=np.inf))
    assert [e for e in found.events if e.stage == "idle"] == []
    assert [f.effect.joint for f in found.faults] == [JOINT]
