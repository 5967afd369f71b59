"""Arms at rest, and joints that move in one log only."""

import numpy as np

from cdia_pin import Dynamics, load_robot
from cdia_pin.discovery import discover
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.experiment import Experiment
from cdia_pin.viewers.short_answer import short_answer

POSE = np.array([0.1, -1.0, 1.0, 0.3, 0.2, 0.1])


def test_an_arm_at_rest_under_a_constant_torque_gets_an_answer():
    arm, t = load_robot("ur5"), np.arange(0, 20, 0.01)
    still = np.zeros(6)
    torque = 1.05 * arm.inverse_dynamics(POSE, still, still) + 0.3
    log = Log(arm.joints, t, np.tile(POSE, (len(t), 1)), effort=np.tile(torque, (len(t), 1)))
    found = discover(Dynamics(arm), log)
    assert found.verdict == "explained"
    assert found.counted.all()
    assert dict(short_answer(found))["at rest"] == "all 6 joints: what they show is likely at most"
    assert all(t.effect.is_physical(np.array(t.theta), arm) for t in found.model.terms)


def test_a_joint_that_moves_in_one_of_several_logs_is_no_resting_joint():
    arm, t = load_robot("ur5"), np.arange(0, 10, 0.01)
    logs = []
    for j in range(3):
        q = np.tile(POSE, (len(t), 1))
        q[:, j] += 0.5 * np.sin(t)
        logs.append(Log(arm.joints, t, q, effort=np.zeros_like(q), source=f"{j}.csv"))
    seen = Experiment.of(arm, [condition(log, arm) for log in logs])
    assert seen.resting.tolist() == [False, False, False, True, True, True]
