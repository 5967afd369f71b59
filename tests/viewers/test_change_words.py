"""A sentence about a change states a parameter that did change."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot, what_changed
from cdia_pin.effects import Term, parse_term
from cdia_pin.phrases import NO_BREAK
from cdia_pin.viewers.change_words import change_words
from tests.changes.test_conditions import pair

ASYMMETRIC = (
    "asymmetric_friction@joint1: level_positive=-0.03, level_negative=0.28, coefficient_positive=-0.43"
)


@pytest.fixture(scope="module")
def found():
    robot = load_robot("double_pendulum")
    return what_changed(Dynamics(robot), *pair(robot, 0.1, 0.2))


def words(found, term: Term, half: list[float]) -> str:
    (change, *_) = found.changes
    return change_words(replace(change, term=term.with_intervals(np.array(half)), before=None), found)


@pytest.mark.parametrize(
    ("half", "stated"),
    [
        ([0.36, 0.65, 0.25, 0.5], "coefficient positive −0.43 ± 0.25 N·m·s/rad"),
        ([0.01, 0.65, 0.25, 0.5], "−0.030 ± 0.010 N·m"),  # the main parameter needs no name
        ([0.36, 0.10, 0.25, 0.5], "level negative +0.28 ± 0.10 N·m"),  # the surest of two
        ([0.36, 0.65, 0.50, 0.5], "−0.03 ± 0.36 N·m"),  # none changed by itself
    ],
)
def test_it_states_a_parameter_whose_interval_leaves_zero_out(found, half, stated):
    said = words(found, parse_term(ASYMMETRIC), half).replace(NO_BREAK, " ")
    assert said == f"asymmetric friction on joint1 {stated}"
