"""Efforts whose sign was lost are no torques, and a torque of one sign keeps it."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin.logs import check_log
from cdia_pin.logs.checks.unsigned import FOLDS, folds, unsigned

TIME = np.arange(0.0, 30.0, 0.01)
RNG = np.random.default_rng(0)


def test_a_magnitude_is_folded_at_each_change_of_sign():
    torque = 5.0 * np.sin(TIME)  # nine changes of sign in 30 s
    assert folds(np.abs(torque)) == 9
    assert folds(-np.abs(torque)) == 9  # of a drive whose gain is negative
    assert folds(torque) == 0


@pytest.mark.parametrize("least", [0.01, 0.3])
def test_a_torque_that_turns_near_zero_is_no_magnitude(least):
    assert folds(5.0 * (1.0 + np.sin(TIME)) + least) == 0


def test_a_noisy_torque_that_comes_near_zero_is_no_magnitude():
    assert folds(5.0 * (1.02 + np.sin(TIME)) + 0.05 * RNG.normal(size=TIME.size)) < FOLDS


@pytest.mark.parametrize("effort", [np.zeros(100), np.ones(100), np.r_[np.zeros(50), np.ones(50)]])
def test_a_constant_effort_or_a_step_is_no_magnitude(effort):
    assert folds(effort) == 0


def test_signed_logs_are_signed(measured_logs):
    assert [log.source for log, _ in measured_logs if unsigned(log).any()] == []


def test_a_measured_log_without_signs_is_refused_and_no_other_sign_is_proposed(measured_logs):
    for log, arm in measured_logs:
        if "exciting" in log.source:
            found, *others = check_log(replace(log, effort=np.abs(log.effort)), arm).about("sign")
            assert found.severity == "error"
            assert "its sign is lost" in found.message
            assert [f.severity for f in others if f.severity not in ("ok", "info")] == []


def test_one_joint_without_sign_is_named(plant, ur5):
    log = plant(ur5)
    effort = log.effort.copy()
    effort[:, 3] = np.abs(effort[:, 3] - effort[:, 3].mean())
    found = [f for f in check_log(replace(log, effort=effort), ur5).about("sign") if f.severity == "error"]
    assert [f.joint for f in found] == [ur5.joints[3]]
    (moves,) = (
        f for f in check_log(replace(log, effort=effort), ur5).about("excitation") if f.joint == ur5.joints[3]
    )
    assert moves.value["moves"]


def test_coarse_efforts_alone_prove_nothing(plant, ur5):
    log = plant(ur5)
    effort = np.zeros_like(log.effort)
    effort[::7, 0] = 0.1  # one step of the sensor, now and then
    assert not unsigned(replace(log, effort=effort)).any()


def test_a_noisy_torque_that_stays_near_zero_for_a_while_is_no_magnitude():
    """Before, single samples near zero of a small steady torque were folds, and long logs have many of them."""
    torque = np.where(np.sin(TIME) > 0, 5.0 * np.sin(TIME), 0.0)
    steady = np.abs(0.04 + 0.012 * RNG.normal(size=TIME.size)) + torque
    assert folds(steady) < FOLDS
