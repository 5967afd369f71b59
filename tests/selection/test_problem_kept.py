"""Logs that are conditioned once answer several questions as if each had been asked alone."""

import numpy as np
import pytest

from cdia_pin import Dynamics, add_effect, compare, discover, read_log
from cdia_pin.discovery import add_effect_in, compare_in, discover_in
from cdia_pin.effects import parse_effect
from cdia_pin.resources import logs_dir
from cdia_pin.selection import DiscoverySettings, Problem


@pytest.fixture(scope="module")
def log(ur5):
    return read_log(logs_dir() / "demo_ur5.csv", ur5).slice(0, 2500)


@pytest.fixture(scope="module")
def kept(ur5, log):
    return Problem.conditioned(ur5, [log], [], DiscoverySettings())


def test_effects_added_one_after_the_other(ur5, log, kept):
    fresh = asked = Dynamics(ur5)
    for text in ("payload", "position_ripple@elbow_joint", "coulomb_friction@elbow_joint"):
        effect = parse_effect(text, ur5)
        fresh = add_effect(fresh, effect, log).model
        asked = add_effect_in(kept.around(asked), asked, effect).model
        assert asked.terms == fresh.terms
        assert asked.find(text).ci95 == fresh.find(text).ci95


def test_a_discovery_after_other_questions(ur5, log, kept):
    model = add_effect(Dynamics(ur5), parse_effect("payload", ur5), log).model
    fresh, asked = discover(model, log), discover_in(kept.around(model), model)
    assert asked.model.terms == fresh.model.terms
    assert [r.term for r in asked.ranking] == [r.term for r in fresh.ranking]


def test_a_comparison(ur5, log, kept):
    fresh, asked = compare(Dynamics(ur5), log), compare_in(kept.experiment, Dynamics(ur5))
    np.testing.assert_array_equal(asked.residual, fresh.residual)
    assert asked.to_dict() == fresh.to_dict()
