"""A healthy arm never crosses its threshold, however its unmodelled torques are signed."""

from itertools import product

import numpy as np
import pytest

from cdia_pin.campaigns.scara_run import desired
from cdia_pin.diagnosis.thesis.threshold import DynamicThreshold, TimeVaryingThreshold, decay
from cdia_pin.robot import scara

GAMMA = np.full(4, 100.0)
BOUND = np.array([1.0, 0.3, 0.001, 1.0])
PATTERNS = np.array(list(product((-1.0, 1.0), repeat=4)))
DURATION = 0.002


def inertias():
    return [np.linalg.inv(scara.mass_matrix(desired(t)[0])) for t in np.arange(0.0, 6.0, DURATION)]


def residuals(inverse, patterns=PATTERNS):
    """The observer's error under constant η = ±η₀ for each pattern, (K, 16, 4)."""
    left, gain = decay(GAMMA, DURATION)
    error, out = np.zeros(patterns.shape), []
    for Mi in inverse:
        error = left * error + gain * ((patterns * BOUND) @ Mi.T)
        out.append(error)
    return np.array(out)


def bounds(threshold, inverse):
    return np.array([threshold.step(Mi, DURATION).copy() for Mi in inverse])


@pytest.mark.parametrize("form", [DynamicThreshold, TimeVaryingThreshold])
def test_no_sign_pattern_of_the_unmodelled_torque_alarms(form):
    inverse = inertias()
    assert len(PATTERNS) == 16
    bound = bounds(form(GAMMA, BOUND), inverse)[:, None]
    assert (np.abs(residuals(inverse)) <= bound * (1 + 1e-12)).all()


def test_the_dynamic_threshold_is_reached_so_none_lower_would_do():
    inverse = inertias()
    share = np.abs(residuals(inverse)) / bounds(DynamicThreshold(GAMMA, BOUND), inverse)[:, None]
    assert share.max() == pytest.approx(1.0, abs=1e-9)


def test_the_printed_form_alarms_on_most_patterns():
    inverse = inertias()
    left, gain = decay(GAMMA, DURATION)
    value, printed = np.zeros(4), []
    for Mi in inverse:
        value = left * value + gain * np.abs(Mi @ BOUND)  # the absolute value outside the product
        printed.append(value)
    alarms = (np.abs(residuals(inverse)) > np.array(printed)[:, None] * (1 + 1e-9)).any(axis=(0, 2))
    assert alarms.sum() >= 12


def test_the_time_varying_threshold_is_never_below_the_dynamic_one():
    inverse = inertias()
    wide, narrow = (bounds(form(GAMMA, BOUND), inverse) for form in (TimeVaryingThreshold, DynamicThreshold))
    assert (wide >= narrow * (1 - 1e-12)).all()
    assert (wide > 1.5 * narrow).any()


def test_a_step_is_exact_whatever_its_length():
    left, gain = decay(GAMMA, 0.01)
    half_left, half_gain = decay(GAMMA, 0.005)
    np.testing.assert_allclose(left, half_left**2)
    np.testing.assert_allclose(gain, half_left * half_gain + half_gain)
