"""The sign of a speed in a sampled motion: a step between two samples is neither late nor early."""

import numpy as np
import pytest

from cdia_pin.effects.smooth_sign import smooth_sign
from cdia_pin.logs.derivatives import zero_phase

RATE, CUTOFF, FINER = 80.0, 10.0, 64  # [Hz], [Hz], [1]
ACCELERATION, WIDTH = 5.0, 1e-3  # [rad/s²], [rad/s]


def filtered_step(rate: float, at: float, period: float) -> np.ndarray:
    """Sign of a speed that passes zero, filtered, at every sample of `RATE`."""
    count = round(rate / RATE)
    v = ACCELERATION * (np.arange(80 * count) / rate - at)
    return zero_phase(smooth_sign(v, WIDTH, ACCELERATION, period), CUTOFF, rate)[::count]


@pytest.mark.parametrize("part", [0.0, 0.1, 0.3, 0.5, 0.8])
def test_a_step_between_two_samples_is_at_its_time(part):
    at = (40 + part) / RATE
    true = filtered_step(FINER * RATE, at, 0.0)
    assert filtered_step(RATE, at, 1 / RATE) == pytest.approx(true, abs=0.02)


def test_a_step_that_is_sampled_at_instants_is_late_or_early():
    at = 40.3 / RATE
    assert np.abs(filtered_step(RATE, at, 0.0) - filtered_step(FINER * RATE, at, 0.0)).max() > 0.1


def test_at_an_instant_it_is_a_smooth_step():
    v = np.linspace(-3.0, 3.0, 61)
    assert smooth_sign(v, 0.5) == pytest.approx(np.tanh(v / 0.5), abs=1e-15)


def test_each_joint_has_its_width_and_both_ways_are_alike():
    v, width = np.linspace(-1.0, 1.0, 41)[:, None] * [1.0, 2.0], np.array([0.1, 0.3])
    slow = smooth_sign(v, width, np.full(v.shape, 1e-4), 1.0)
    assert slow == pytest.approx(np.tanh(v / width), abs=1e-8)
    up, down = (smooth_sign(v, width, s * 0.2 * np.ones_like(v), 1.0) for s in (1, -1))
    assert up == pytest.approx(down, abs=1e-12)
    assert up == pytest.approx(-smooth_sign(-v, width, 0.2 * np.ones_like(v), 1.0), abs=1e-12)


@pytest.mark.parametrize("change", [0.0, 1e-9, 1e-3, 1.0, 1e9])
def test_no_speed_is_too_large_for_it(change):
    found = smooth_sign(np.array([-1e9, -1.0, 0.0, 1.0, 1e9]), 1e-6, change, 1.0)
    assert np.isfinite(found).all()
    assert np.abs(found).max() < 13 / 12 + 1e-12
    assert found[2] == 0.0
