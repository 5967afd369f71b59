"""Isolation, accommodation and idle monitoring, each by itself."""

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.diagnosis.thesis import KnownEffects, Neurons, ThesisSettings
from cdia_pin.diagnosis.thesis.accommodation import accommodate
from cdia_pin.diagnosis.thesis.clearance import ClearanceMonitor
from cdia_pin.diagnosis.thesis.filter_bank import hypotheses
from cdia_pin.effects import (
    ActuatorGain,
    CoulombFriction,
    EffortDelay,
    JointState,
    LoadFriction,
    State,
    Unknown,
    ViscousFriction,
)
from cdia_pin.errors import EffectError, ModelError

FREE = np.full(2, np.inf)


# ------------------------------------------------------------- isolation


@pytest.mark.parametrize("known", range(6))
def test_a_bank_holds_every_combination_once(known):
    found = hypotheses(known)
    assert len(found) == len(set(found)) == 2**known - 1
    assert all(found)


def test_a_reduced_bank_counts_the_types_that_were_isolated():
    isolated = frozenset({0, 2})
    found = hypotheses(5, isolated)
    assert len(found) == 2 ** (5 - 2) - 1
    assert all(isolated < one for one in found)


# ------------------------------------------------------------- bases


def joint_state(robot, seed=0):
    q, v, a, tau = np.random.default_rng(seed).normal(size=(4, robot.n))
    return State.of(robot, q, v, a, effort=tau, sign_width=0.1), JointState(
        q, v, a, tau, np.tanh(v / 0.1), np.zeros(robot.n)
    )


def test_known_effects_on_all_joints_at_once_are_those_of_each_joint():
    robot = load_robot("scara")
    basis = KnownEffects.of(robot, (ActuatorGain, CoulombFriction, LoadFriction, ViscousFriction))
    weights = np.random.default_rng(1).uniform(0.1, 0.9, (4, 4))
    x, joints = joint_state(robot)
    terms = basis.terms(weights, np.ones((4, 4), dtype=bool))
    assert len(terms) == 16
    one_by_one = sum(term.torque(x)[0] for term in terms)
    np.testing.assert_allclose((basis.columns(joints) * weights).sum(axis=1), one_by_one)


def test_neurons_are_the_effect_unknown_of_each_joint():
    robot = load_robot("scara")
    neurons = Neurons.over(robot, np.array([1.0, 2.0, 3.0, 0.2]), np.array([2.0, 3.0, 4.0, 1.0]), 5)
    x, joints = joint_state(robot)
    for j, name in enumerate(robot.joints):
        one = Unknown(
            name,
            tuple(neurons.position_centres[j]),
            tuple(neurons.velocity_centres[j]),
            neurons.position_width[j],
            neurons.velocity_width[j],
        )
        np.testing.assert_allclose(neurons.columns(joints)[j], one.basis(x)[0, j])


def test_known_effects_stay_physical():
    lower, upper = KnownEffects.of(load_robot("scara"), (ActuatorGain, CoulombFriction)).bounds
    assert lower.shape == upper.shape == (4, 2)
    assert (lower[:, 0] > -1).all()
    assert (lower[:, 1] == 0).all()


@pytest.mark.parametrize("bank", [(EffortDelay,), ("coulomb_friction",), (ActuatorGain, ActuatorGain)])
def test_a_bank_refuses_what_it_cannot_test(bank):
    with pytest.raises(EffectError, match="a bank holds"):
        KnownEffects.of(load_robot("scara"), bank)


# ------------------------------------------------------------- accommodation


@pytest.mark.parametrize("nominal", [(12.0, -7.0), (-3.0, 0.5)])
@pytest.mark.parametrize("gain", [-0.6, 0.8])
def test_the_corrected_torque_does_what_the_nominal_one_would(nominal, gain):
    fault = lambda tau: gain * tau - np.array([0.3, -0.2])  # noqa: E731
    tau = accommodate(np.array(nominal), fault, 0.1, FREE)
    np.testing.assert_allclose(tau + fault(tau), nominal)


def test_friction_in_proportion_to_the_torque_is_solved_for_either_sign():
    # of a small nominal torque against an offset: the corrected torque changes sign
    fault = lambda tau: -0.3 * np.abs(tau) + np.array([5.0, -5.0])  # noqa: E731
    nominal = np.array([1.0, -1.0])
    tau = accommodate(nominal, fault, 0.1, FREE)
    np.testing.assert_allclose(tau + fault(tau), nominal)
    assert (tau * nominal < 0).all()


def test_a_dead_actuator_gets_the_nominal_torque():
    np.testing.assert_array_equal(
        accommodate(np.array([5.0, 5.0]), lambda tau: np.array([-0.95, -0.5]) * tau, 0.1, FREE), [5.0, 10.0]
    )


def test_an_estimate_that_is_not_finite_is_not_applied():
    tau = accommodate(np.array([5.0, 5.0]), lambda tau: np.array([np.nan, 1.0]), 0.1, FREE)
    np.testing.assert_array_equal(tau, [5.0, 4.0])


def test_torques_stay_within_the_limits():
    tau = accommodate(np.array([50.0, -50.0]), lambda tau: -0.5 * tau, 0.1, np.array([60.0, 80.0]))
    np.testing.assert_array_equal(tau, [60.0, -80.0])


# ------------------------------------------------------------- idle


def quiet_after(torques, time=0.5, step=0.1):
    monitor = ClearanceMonitor(np.ones(2), time)
    for k, torque in enumerate(torques):
        if monitor.step({3: np.array(torque)}, step):
            return (k + 1) * step
    return None


def test_an_effect_is_absent_once_its_torque_was_small_for_long_enough():
    assert quiet_after([(0.5, -0.9)] * 9) == pytest.approx(0.5)
    assert quiet_after([(0.5, 0.1)] * 4 + [(2.0, 0.1)] + [(0.5, 0.1)] * 9) == pytest.approx(1.0)


def test_torques_of_opposite_signs_do_not_cancel():
    assert quiet_after([(5.0, -5.0)] * 20) is None


# ------------------------------------------------------------- settings


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"gamma": 0.0}, "gamma"),
        ({"grace": -1.0}, "grace"),
        ({"threshold": "dynamik"}, "did you mean dynamic"),
        ({"longest_isolation": 0.1}, "longest_isolation"),
        ({"neurons": 1}, "neurons"),
    ],
)
def test_impossible_settings_are_refused(settings, said):
    with pytest.raises(ModelError, match=said):
        ThesisSettings(**settings)
