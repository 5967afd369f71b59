"""The cut-off follows the log, and not the rate at which it was recorded."""

import numpy as np
import pytest

from cdia_pin import Log, load_robot
from cdia_pin.logs.conditioning import condition
from tests.made_logs import motion


def log_at(robot, rate):
    """The same motion and torque at another rate; the torque switches, as dry friction does."""
    t, q, v, a = motion(robot.n, 3, duration=20.0)
    effort = robot.inverse_dynamics(q, v, a) + 0.3 * np.sign(v)
    time = np.arange(0.0, 19.9, 1.0 / rate)
    position, torque = (np.column_stack([np.interp(time, t, c) for c in x.T]) for x in (q, effort))
    return Log(robot.joints, time, position, torque)


@pytest.mark.parametrize(("rates", "cutoff"), [((200.0, 250.0), 25.0), ((125.0, 100.0, 94.0, 75.0), 10.0)])
def test_a_log_is_filtered_alike_at_other_rates(rates, cutoff):
    robot = load_robot("double_pendulum")
    assert [condition(log_at(robot, rate), robot).cutoff for rate in rates] == [cutoff] * len(rates)
