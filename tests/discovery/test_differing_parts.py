"""Friction is asymmetric, or drifts, if no half of the log contradicts; beside other structure, half must show it."""

from types import SimpleNamespace

import numpy as np
import pytest

from cdia_pin.discovery.differing_parts import differs
from cdia_pin.effects import AsymmetricFriction, Term, ViscousFriction, parse_term
from cdia_pin.effects.drift import Drift

ASYMMETRIC = parse_term("asymmetric_friction@joint2: level_positive=0.5, level_negative=0.3")
DRIFTING = Term(Drift(ViscousFriction("joint2"), 0.0, 10.0, 20.0), (0.5, 0.3))


def fit(difference, spread, halves=()):
    """Return what a fit says of the difference between the first two parameters."""
    return SimpleNamespace(
        theta=lambda t: np.array([0.4 + difference / 2, 0.4 - difference / 2, 0.0, 0.0])[: t.effect.size],
        covariance=lambda t: np.eye(t.effect.size) * spread**2 / 2,
        torque=lambda _, theta: np.abs(theta).max(keepdims=True),
        halves=halves,
    )


@pytest.mark.parametrize("term", [ASYMMETRIC, DRIFTING], ids=["asymmetric", "drifting"])
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
def test_what_the_halves_must_show(term, halves, beside_structure, answer):
    assert differs(fit(0.2, 0.04, [fit(*h) for h in halves]), term, beside_structure) is answer


def test_a_drift_compares_each_parameter_at_both_ends():
    drift = Drift(AsymmetricFriction("joint2"), 0.0, 10.0, 20.0)

    def whole(theta):
        return SimpleNamespace(
            theta=lambda _: np.array(theta),
            covariance=lambda _: np.eye(8) * 1e-4,
            torque=lambda _, x: np.abs(x).max(keepdims=True),
            halves=(),
        )

    both_ways, warmer = (0.5, 0.3, 0.0, 0.0, 0.5, 0.3, 0.0, 0.0), (0.5, 0.3, 0.0, 0.0, 0.3, 0.2, 0.0, 0.0)
    assert not differs(whole(both_ways), Term(drift, both_ways), beside_structure=False)
    assert differs(whole(warmer), Term(drift, warmer), beside_structure=False)
