"""Which effects a motion can show."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.experiment import Experiment
from cdia_pin.selection import DiscoverySettings
from cdia_pin.selection.candidates import enumerate_candidates
from tests.made_logs import make


@pytest.mark.parametrize("back", [0.0, 0.3])
def test_friction_that_differs_by_direction_needs_a_joint_that_moves_both_ways(back):
    arm = load_robot("scara")
    log = make(arm).log
    position = log.position.copy()
    slow = 0.2 * np.sin(2 * np.pi * 0.5 * log.time) / (2 * np.pi * 0.5)  # 0.2 rad/s
    position[:, 0] = (0.21 - back) * log.time + slow
    experiment = Experiment.of(arm, [condition(replace(log, position=position), arm)])
    families = enumerate_candidates(experiment, experiment.predict(Dynamics(arm)), DiscoverySettings())
    labels = {f[0].label for f in families}
    first, second = (f"asymmetric_friction@{j}" in labels for j in arm.joints[:2])
    assert second
    assert first == (back > 0)
    assert f"coulomb_friction@{arm.joints[0]}" in labels
