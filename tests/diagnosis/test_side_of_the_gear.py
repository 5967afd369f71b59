"""A monitor tests the effects that the torque sensors of its healthy runs see."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, Monitor, load_robot
from cdia_pin.logs.torque_side import TorqueSide
from tests.made_logs import make, nothing

AT = 1  # index of the joint whose bearings rub


def rubbing(q, v, a):
    f = np.zeros_like(v)
    f[len(v) // 2 :, AT] = -(0.2 * np.tanh(v[:, AT] / 0.005) + 0.1 * v[:, AT])[len(v) // 2 :]
    return f


def run_of(robot, missing, seed):
    made = make(robot, missing, seed=seed, rate=500.0, noise=0.01)
    return replace(made.log, velocity=made.v, torque_side=TorqueSide.LINK)


@pytest.fixture(scope="module")
def monitor():
    robot = load_robot("double_pendulum")
    return Monitor(Dynamics(robot), healthy=[run_of(robot, nothing, 1)])


def test_bearings_that_rub_have_their_name_behind_the_gear(monitor):
    monitor.replay(run_of(monitor.model.robot, rubbing, 2))
    (fault,) = monitor.faults
    assert fault.label == "bearing_friction@joint2"
    np.testing.assert_allclose(fault.theta, [0.2, 0.1], rtol=0.15)


def test_a_healthy_run_has_none(monitor):
    monitor.replay(run_of(monitor.model.robot, nothing, 3))
    assert monitor.events == ()
