"""What a model lets a user notice: the smallest push is that of the direction in which the arm shows least."""

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.discovery.capability import capability_of
from cdia_pin.regression.experiment import Experiment
from cdia_pin.selection.discovery_settings import ChangeSettings
from tests.made_logs import conditioned, make


@pytest.mark.parametrize("name", ["ur10", "panda"])
def test_a_push_is_noticed_whatever_its_direction(name):
    robot = load_robot(name)
    experiment = Experiment.of(robot, [conditioned(robot, make(robot))])
    error, torque = np.linspace(0.2, 2.0, robot.n), np.linspace(5.0, 50.0, robot.n)
    able = capability_of(experiment, error, torque, ChangeSettings())
    jacobian = np.vstack([np.asarray(robot.tool_jacobian(s.state.q))[:, :3, :] for s in experiment.segments])
    way = np.random.default_rng(0).normal(size=(2000, 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    shown = np.sqrt(np.mean(np.einsum("da,kaj->dkj", way, jacobian) ** 2, axis=1))  # [N·m/N]
    needed = (able.friction / shown).min(axis=1)  # friction is noticed by the same torque
    assert able.push == pytest.approx(needed.max(), rel=0.02)
