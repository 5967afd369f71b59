"""Base parameters: what torques depend on, and nothing else."""

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.identification.base import base_parameters, base_reduction


def states(robot, seed=1, count=50):
    rng = np.random.default_rng(seed)
    return rng.uniform(-1, 1, (count, robot.n)), *rng.normal(size=(2, count, robot.n))


# 6R arms with parallel shoulder and elbow axes have 36, the Panda 43 [Gaz et al. 2019].
@pytest.mark.parametrize(("robot", "count"), [("ur5", 36), ("ur10", 36), ("panda", 43)])
def test_arms_have_as_many_base_parameters_as_published(robot, count):
    lead, reduction = base_reduction(load_robot(robot))
    assert len(lead) == count
    assert reduction.shape == (count, 10 * load_robot(robot).n)


@pytest.mark.parametrize("robot", ["ur5", "panda", "double_pendulum", "scara"])
def test_a_change_that_leaves_them_alone_leaves_torques_alone(robot):
    arm = load_robot(robot)
    _, reduction = base_reduction(arm)
    rng = np.random.default_rng(0)
    change = rng.normal(size=10 * arm.n)
    change -= np.linalg.pinv(reduction) @ (reduction @ change)  # into the null space
    assert np.linalg.norm(change) > 0.1
    Y = arm.torque_regressor(*states(arm))
    assert np.abs(Y @ change).max() < 1e-8 * np.abs(Y).max()


@pytest.mark.parametrize("robot", ["ur5", "panda"])
def test_no_change_of_one_of_them_leaves_torques_alone(robot):
    arm = load_robot(robot)
    lead, _ = base_reduction(arm)
    Y = arm.torque_regressor(*states(arm, count=200)).reshape(-1, 10 * arm.n)[:, list(lead)]
    values = np.linalg.svd(Y / np.linalg.norm(Y, axis=0), compute_uv=False)
    assert values[-1] > 1e-6 * values[0]


def test_values_deviations_and_what_is_identifiable():
    arm = load_robot("ur5")
    _, reduction = base_reduction(arm)
    n = 10 * arm.n
    change = np.random.default_rng(3).normal(size=n)
    known = np.eye(n)
    base = base_parameters(arm, change, 0.01 * known, known, 2.0, np.zeros(arm.n))
    assert base.value - base.urdf == pytest.approx(reduction @ change)
    assert base.deviation == pytest.approx(0.1 * np.linalg.norm(reduction, axis=1))
    assert base.half_width == pytest.approx(2 * base.deviation)
    assert base.identifiable.all()
    assert not base_parameters(arm, change, known, known, 2.0, np.zeros(arm.n)).identifiable.any()
    assert base.moved == pytest.approx(np.abs(reduction @ change) / base.deviation)
    assert len(base) == len(base.names) == 36
    assert base.names[0].startswith(arm.joints[0])
