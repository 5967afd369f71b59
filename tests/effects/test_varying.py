"""Effects whose parameters vary: with equal parts they are the plain effect, and files keep them."""

import json

import numpy as np
import pytest

from cdia_pin import Dynamics, load_model, load_robot, save_model
from cdia_pin.dynamics import exciting_trajectory
from cdia_pin.effects import Drift, PerLog, State, Term, effect_from_dict, parse_effect
from cdia_pin.errors import EffectError

EFFECTS = {
    "coulomb_friction@elbow_joint": [2.0],
    "asymmetric_friction@elbow_joint": [1.0, 2.0, 0.5, 0.2],
    "payload": [1.0, 0.01, 0.02, 0.05, 0.02, 0.0, 0.02, 0.0, 0.0, 0.02],
    "effort_delay": [0.01],
    "load_friction@elbow_joint": [0.1],
}
LOGS = ("cold", "warm")


@pytest.fixture(scope="module")
def ur5():
    return load_robot("ur5")


def state(robot, log=""):
    time = np.linspace(0.0, 10.0, 41)
    q, v, a = exciting_trajectory(robot, np.random.default_rng(2), duration=10.0)(time)
    tau = robot.inverse_dynamics(q, v, a)
    return State(robot, q, v, a, tau, time, np.full(robot.n, 0.01), log)


def variants(effect):
    return [PerLog(effect, LOGS), Drift(effect, 0.0, 10.0, 3.0)]


@pytest.mark.parametrize("label", EFFECTS)
def test_equal_parts_are_the_plain_effect(label, ur5):
    effect, theta = parse_effect(label), np.array(EFFECTS[label])
    x = state(ur5, "warm")
    for varying in variants(effect):
        both = np.tile(theta, 2)
        np.testing.assert_allclose(varying.torque(x, both), effect.torque(x, theta), atol=1e-12)
        np.testing.assert_allclose(
            varying.jacobian(x, both).reshape(*x.q.shape, 2, -1).sum(axis=2),
            effect.jacobian(x, theta),
            atol=1e-9,
        )


def test_each_log_has_its_own_parameters_and_any_other_motion_their_mean(ur5):
    effect = parse_effect("coulomb_friction@elbow_joint")
    both = PerLog(effect, LOGS)
    for log, level in (("cold", 3.0), ("warm", 1.0), ("neither", 2.0)):
        x = state(ur5, log)
        np.testing.assert_allclose(both.torque(x, np.array([3.0, 1.0])), effect.torque(x, np.array([level])))
    assert both.of_part((3.0, 1.0), "warm") == (1.0,)


@pytest.mark.parametrize("time_constant", [0.5, 5.0, 1e6])
def test_a_drift_goes_from_its_first_parameters_to_its_last(time_constant, ur5):
    x = state(ur5)
    weights = Drift(parse_effect("torque_offset@elbow_joint"), 0.0, 10.0, time_constant).weights(x)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0)
    np.testing.assert_allclose(weights[[0, -1]], [[1, 0], [0, 1]], atol=1e-12)
    assert (np.diff(weights[:, 1]) >= 0).all()
    middle = weights[20, 1]  # exponential: most of it early; linear in the limit
    assert middle == pytest.approx(0.5, abs=1e-3) if time_constant > 1e3 else middle > 0.5


def test_a_drift_is_no_forecast(ur5):
    x = state(ur5)
    weights = Drift(parse_effect("torque_offset@elbow_joint"), 2.0, 6.0, 3.0).weights(x)
    np.testing.assert_allclose(weights[x.time <= 2.0], [[1.0, 0.0]] * 9)
    np.testing.assert_allclose(weights[x.time >= 6.0], [[0.0, 1.0]] * 17, atol=1e-12)


@pytest.mark.parametrize("label", EFFECTS)
def test_files_keep_how_an_effect_varies(label, ur5, tmp_path):
    terms = tuple(Term(e, tuple(EFFECTS[label]) * 2) for e in variants(parse_effect(label)))
    for term in terms:
        assert effect_from_dict(json.loads(json.dumps(term.effect.to_dict()))) == term.effect
    model = Dynamics(ur5, terms)
    assert load_model(save_model(model, tmp_path / "model.json"), ur5) == model
    assert model.find(f"{label}[log]") == terms[0]


def test_bad_variations_are_refused_with_what_is_valid(ur5):
    effect = parse_effect("coulomb_friction@elbow_joint")
    with pytest.raises(EffectError, match="different names"):
        PerLog(effect, ("a", "a"))
    with pytest.raises(EffectError, match="time constant above 0"):
        Drift(effect, 0.0, 10.0, 0.0)
    with pytest.raises(EffectError, match="encoder"):
        PerLog(parse_effect("encoder_offset@elbow_joint"), LOGS)
    with pytest.raises(EffectError, match="variation"):
        effect_from_dict({**effect.to_dict(), "varies": {"with": "weather"}})
    with pytest.raises(EffectError, match="varies with log"):
        effect_from_dict({**effect.to_dict(), "varies": {"with": "log"}})
