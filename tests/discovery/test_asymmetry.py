"""Friction is asymmetric if no half of the log contradicts; beside other structure, half of it must show it."""

from types import SimpleNamespace

import numpy as np
import pytest

from cdia_pin.discovery.asymmetry import is_asymmetric
from cdia_pin.effects import parse_term

TERM = parse_term("asymmetric_friction@joint2: level_positive=0.5, level_negative=0.3")


def fit(difference, spread, halves=()):
    """Return what a fit says of the difference between the directions."""
    return SimpleNamespace(
        theta=lambda _: np.array([0.4 + difference / 2, 0.4 - difference / 2, 0.0, 0.0]),
        covariance=lambda _: np.eye(4) * spread**2 / 2,
        torque=lambda _, theta: np.abs(theta).max(keepdims=True),
        halves=halves,
    )


@pytest.mark.parametrize(
    ("halves", "beside_structure", "answer"),
    [
        (((0.2, 0.02), (0.2, 0.02)), True, True),
        (((0.2, 0.02), (0.1, 0.10)), True, True),  # the joint hardly moves in one half
        (((0.2, 0.02), (0.0, 0.02)), False, False),
        (((0.2, 0.06), (0.2, 0.06)), False, True),  # neither half can tell
        (((0.2, 0.06), (0.2, 0.06)), True, False),
    ],
)
def test_what_the_halves_must_show(halves, beside_structure, answer):
    assert is_asymmetric(fit(0.2, 0.04, [fit(*h) for h in halves]), TERM, beside_structure) is answer
