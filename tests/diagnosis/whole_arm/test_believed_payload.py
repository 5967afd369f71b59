"""A payload that was just named may be off by a share of its whole torque, also where gravity shows nothing of it."""

import numpy as np

from cdia_pin import Dynamics, load_robot
from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings


def test_a_small_error_of_a_payload_is_no_alarm_of_a_light_joint():
    settings = LoopSettings(rate=500.0, healthy_runs=1, healthy_duration=10.0, seed=3)
    loop = ClosedLoop(Dynamics(load_robot("double_pendulum")), settings)
    monitor = loop.monitor(bank=("coulomb_friction", "viscous_friction"))
    log = loop.run(loop.motion(0, 3.0)).log
    arm, observer = monitor.engine.arm, monitor.engine.observer

    def feed(start, stop):
        for k in range(start, stop):
            monitor.update(log.time[k], log.position[k], log.velocity[k], log.effort[k])

    feed(0, 1000)
    inertial = 20.0 * observer.threshold
    arm.evidence.columns[:, 0] = inertial
    observer.state.residual = observer.residual + inertial
    arm._move(0, np.array([0.9, 0.0, 0.0, 0.0]))  # a tenth is missed: twice the threshold
    feed(1000, 1020)
    assert not [e for e in monitor.events if e.stage == "detection"]
