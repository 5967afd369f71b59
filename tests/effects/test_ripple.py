"""Which ripples are searched for on the range that a joint was driven."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.effects import PositionRipple, State
from cdia_pin.effects.actuation import FASTEST_SLIDING, FASTEST_TURNING
from tests.one_joint import write_urdf


def test_a_ripple_is_searched_for_only_where_half_a_period_is_seen():
    robot = load_robot("double_pendulum")
    still = State.of(robot, np.zeros((50, 2)), np.zeros((50, 2)), np.zeros((50, 2)))
    for travel in (0.05, 0.1, 0.5, 1.5, 6.0):
        q = np.linspace(0.0, travel, 50)[:, None] * np.ones(2)
        grid = PositionRipple("joint1").shape_grid(replace(still, q=q))
        assert all(e.frequency * travel >= np.pi * 0.999 for e in grid)
        assert bool(grid) == (travel > np.pi / FASTEST_TURNING)


@pytest.mark.parametrize(("kind", "fastest"), [("revolute", FASTEST_TURNING), ("prismatic", FASTEST_SLIDING)])
def test_a_ripple_of_a_slide_may_repeat_every_few_millimetres(kind, fastest, tmp_path):
    """Per rad and per m are two units, so that one number cannot be the limit of both."""
    robot, q = load_robot(write_urdf(kind, tmp_path)), np.linspace(0.0, 0.8, 50)[:, None]
    grid = [e.frequency for e in PositionRipple("only").shape_grid(State.of(robot, q, 0 * q, 0 * q))]
    assert fastest - 3.0 < max(grid) < fastest
    assert np.diff(grid).max() < np.pi / 0.8  # a frequency between two of them still fits
