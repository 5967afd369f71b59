"""Which ripples are searched for on the range that a joint was driven."""

from dataclasses import replace

import numpy as np

from cdia_pin import load_robot
from cdia_pin.effects import PositionRipple, State
from cdia_pin.effects.actuation import HIGHEST_RIPPLE


def test_a_ripple_is_searched_for_only_where_half_a_period_is_seen():
    robot = load_robot("double_pendulum")
    still = State.of(robot, np.zeros((50, 2)), np.zeros((50, 2)), np.zeros((50, 2)))
    for travel in (0.05, 0.1, 0.5, 1.5, 6.0):
        q = np.linspace(0.0, travel, 50)[:, None] * np.ones(2)
        grid = PositionRipple("joint1").shape_grid(replace(still, q=q))
        assert all(e.frequency * travel >= np.pi * 0.999 for e in grid)
        assert bool(grid) == (travel > np.pi / HIGHEST_RIPPLE)
