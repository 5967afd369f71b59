"""Profiles: where in time or state an effect is present."""

import json

import numpy as np
import pytest

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import (
    ALWAYS,
    Between,
    CoulombFriction,
    Incipient,
    Intermittent,
    Region,
    State,
    Term,
    TorqueOffset,
    ViscousFriction,
    after,
    profile_from_dict,
)
from cdia_pin.errors import EffectError, RobotError
from cdia_pin.robot import load_robot

PROFILES = [
    ALWAYS,
    after(4.0),
    Between(end=2.0),
    Between(1.0, 2.0),
    Region("joint1", "position", -0.5, 0.5),
    Region("joint2", "speed", upper=0.3),
    Region("joint2", "effort", lower=0.1),
    Incipient(1.0, 0.5),
    Intermittent(1.0, 2.0, 0.25),
]
EACH = pytest.mark.parametrize("profile", PROFILES, ids=repr)


@pytest.fixture(scope="module")
def arm():
    return load_robot("double_pendulum")


@pytest.fixture(scope="module")
def state(arm):
    rng = np.random.default_rng(4)
    q, v, tau = rng.normal(size=(3, 50, 2))
    return State.of(arm, q, v, effort=tau, time=np.linspace(0.0, 10.0, 50))


def at(arm, time):
    zero = np.zeros((len(time), 2))
    return State.of(arm, zero, zero, effort=zero, time=time)


@EACH
def test_presence_is_between_none_and_all(state, profile):
    beta = profile(state)
    assert beta.shape == (50,)
    assert (beta >= 0).all() and (beta <= 1).all()


@EACH
def test_a_profile_survives_a_file(profile):
    assert profile_from_dict(json.loads(json.dumps(profile.to_dict()))) == profile
    assert len({profile, profile_from_dict(profile.to_dict())}) == 1


@EACH
def test_a_term_is_its_effect_times_its_profile(arm, state, profile):
    term = Term.of(ViscousFriction("joint1"), profile, coefficient=2.0)
    bare = Term.of(ViscousFriction("joint1"), coefficient=2.0)
    beta = profile(state)[:, None]
    np.testing.assert_allclose(term.torque(state), beta * bare.torque(state), atol=1e-15)
    np.testing.assert_allclose(term.jacobian(state), beta[:, :, None] * bare.jacobian(state), atol=1e-15)


def test_an_abrupt_fault_starts_and_ends_on_time(arm):
    x = at(arm, np.array([0.99, 1.0, 1.5, 2.0, 2.01]))
    np.testing.assert_array_equal(Between(1.0, 2.0)(x), [0, 1, 1, 1, 0])


def test_an_incipient_fault_grows_as_its_rate_says(arm):
    x = at(arm, np.array([0.0, 1.0, 1.5, 100.0]))
    np.testing.assert_allclose(Incipient(1.0, 2.0)(x), [0.0, 0.0, 1 - np.exp(-1.0), 1.0])


def test_an_intermittent_fault_is_there_for_its_duty(arm):
    x = at(arm, np.linspace(0.0, 21.0, 21_001))
    beta = Intermittent(1.0, 2.0, 0.25)(x)
    assert not beta[x.time < 1.0].any()
    assert np.mean(beta[x.time >= 1.0]) == pytest.approx(0.25, abs=1e-3)


def test_a_region_is_of_position_velocity_speed_or_effort(arm):
    q, v, tau = np.array([[0.0, 1.0]]), np.array([[0.0, -2.0]]), np.array([[0.0, 3.0]])
    x = State.of(arm, q, v, effort=tau)
    for signal, value in (("position", 1.0), ("velocity", -2.0), ("speed", 2.0), ("effort", 3.0)):
        assert Region("joint2", signal, value - 0.1, value + 0.1)(x) == 1.0
        assert Region("joint2", signal, value + 0.1)(x) == 0.0


def test_a_model_solves_for_the_torque_where_presence_depends_on_it(arm):
    # An offset of 0.2 N·m that is there while the actuator gives more than 1 N·m
    model = Dynamics(
        arm, (Term.of(TorqueOffset("joint1"), Region("joint1", "effort", lower=1.0), offset=0.2),)
    )
    q, v = np.array([1.2, -0.4]), np.array([0.3, 0.1])
    for a in (np.array([0.0, 0.0]), np.array([4000.0, 3000.0])):
        x = State.of(arm, q, v, a)
        tau = model.torques(x).actuator
        there = tau[0, 0] >= 1.0
        balance = x.rigid_torque - tau - model.missing_torque(x.with_effort(tau))
        assert there == (a[0] > 0)
        np.testing.assert_allclose(balance, 0.0, atol=1e-9)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: Between(2.0, 1.0),
        lambda: Between(start=float("nan")),
        lambda: Between(start="soon"),  # type: ignore[arg-type]
        lambda: Region("joint1", "temperature"),
        lambda: Region(1, "speed"),  # type: ignore[arg-type]
        lambda: Region("joint1", "speed", 2.0, 1.0),
        lambda: Incipient(0.0, 0.0),
        lambda: Incipient(float("inf"), 1.0),
        lambda: Incipient(0.0, float("nan")),
        lambda: Intermittent(0.0, 0.0),
        lambda: Intermittent(0.0, 1.0, 1.5),
        lambda: profile_from_dict({"kind": "sometimes"}),
        lambda: profile_from_dict({"kind": "between", "begin": 3.0}),
        lambda: profile_from_dict({"kind": "between", "start": "3"}),
        lambda: profile_from_dict({"kind": "incipient", "rate": None}),
    ],
)
def test_impossible_profiles_are_refused(wrong):
    with pytest.raises(EffectError):
        wrong()


def test_a_region_of_another_robot_is_refused(arm):
    term = Term.of(CoulombFriction("joint1"), Region("elbow", "speed"), level=1.0)
    with pytest.raises(RobotError, match="elbow"):
        Dynamics(arm, (term,))
