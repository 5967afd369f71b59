"""An effect is added once: what it contains gives way to it, and what contains it is said."""

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.discovery import add_effect
from cdia_pin.effects import parse_effect, parse_term
from cdia_pin.errors import EffectError
from cdia_pin.logs import Log
from cdia_pin.viewers.verdict import verdict_sentences
from tests.made_logs import motion

COULOMB, VISCOUS = "coulomb_friction@joint1: level=0.3", "viscous_friction@joint1: coefficient=0.1"


@pytest.fixture(scope="module")
def robot():
    return load_robot("double_pendulum")


@pytest.fixture(scope="module")
def log(robot):
    """A log of an arm with Coulomb and viscous friction."""
    t, q, v, a = motion(robot.n, 5, duration=12.0)
    effort = model(robot, COULOMB, VISCOUS).inverse_dynamics(q, v, a)
    return Log(robot.joints, t, q, effort + np.random.default_rng(0).normal(0.0, 0.01, effort.shape))


def model(robot, *terms):
    return Dynamics(robot, tuple(map(parse_term, terms)))


def labels(found):
    return {t.label for t in found.model.terms}


@pytest.mark.parametrize(
    ("added", "gives_way"),
    [
        ("stribeck_friction@joint1", "coulomb_friction@joint1"),
        ("asymmetric_friction@joint1", "coulomb_friction@joint1"),
        ("asymmetric_friction@joint1", "viscous_friction@joint1"),
    ],
)
def test_what_an_effect_contains_gives_way_to_it(robot, log, added, gives_way):
    found = add_effect(model(robot, COULOMB, VISCOUS), parse_effect(added, robot), log)
    assert added in labels(found)
    assert gives_way not in labels(found)


@pytest.mark.parametrize(
    ("has", "added"),
    [
        ("stribeck_friction@joint1: level=0.3, decay=10", "coulomb_friction@joint1"),
        ("asymmetric_friction@joint1: level_positive=0.3", "viscous_friction@joint1"),
        ("payload: mass=0.1", "link_inertia@joint2"),
    ],
)
def test_an_effect_that_the_model_contains_is_refused(robot, log, has, added):
    with pytest.raises(EffectError, match=f"{added} adds nothing to {has.partition(':')[0]}"):
        add_effect(model(robot, has), parse_effect(added, robot), log)


def test_effects_that_are_not_the_same_stay_together(robot, log):
    found = add_effect(model(robot, COULOMB), parse_effect("viscous_friction@joint1", robot), log)
    assert labels(found) == {"coulomb_friction@joint1", "viscous_friction@joint1"}
    assert any("once viscous friction" in s for s in verdict_sentences(found))


def test_what_lowers_no_error_is_not_said_to_explain_the_log(robot, log):
    known = model(robot, COULOMB, VISCOUS)
    known = add_effect(known, parse_effect("coulomb_friction@joint1", robot), log).model
    said = " ".join(verdict_sentences(add_effect(known, parse_effect("torque_offset@joint2", robot), log)))
    assert "down to the noise without torque offset on joint2 (perhaps) too" in said
    assert "The error stays at" in said
