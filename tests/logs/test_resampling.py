"""Resampling keeps motion, leaves out what would alias, or keeps the samples of a slower recorder."""

import numpy as np
import pytest

from cdia_pin.logs import Log
from cdia_pin.logs.resampling import resampled, thinned


def log_of(time: np.ndarray, signal: np.ndarray) -> Log:
    both = np.column_stack([signal, -signal])
    return Log(("a", "b"), time, both, 2 * both, 3 * both, temperature=both)


def sine(frequency: float, rate: float, duration: float = 10.0) -> Log:
    time = 5.0 + np.arange(round(duration * rate) + 1) / rate
    return log_of(time, np.sin(2 * np.pi * frequency * time))


@pytest.mark.parametrize(("before", "after"), [(500.0, 100.0), (100.0, 500.0), (100.0, 93.0), (125.0, 500.0)])
def test_slow_motion_is_kept(before, after):
    log = resampled(sine(1.0, before), after)
    assert log.rate == pytest.approx(after)
    assert log.time[0] == 5.0
    middle = np.s_[len(log.time) // 10 : -len(log.time) // 10]
    expected = np.sin(2 * np.pi * log.time)[middle]
    np.testing.assert_allclose(log.position[middle, 0], expected, atol=2e-3)
    np.testing.assert_allclose(log.effort[middle, 1], -2 * expected, atol=6e-3)
    np.testing.assert_allclose(log.velocity[middle, 0], 3 * expected, atol=9e-3)
    assert log.temperature is not None
    assert log.notes[-1] == f"resampled from {before:g} Hz to {after:g} Hz"


def test_what_would_alias_is_left_out():
    fast = sine(95.0, 1000.0)  # would be 5 Hz at 100 Hz
    assert np.abs(resampled(fast, 100.0).position[100:-100]).max() < 0.01
    assert np.abs(thinned(fast, 100.0).position).max() > 0.9


def test_thinned_samples_are_those_of_the_log():
    log = sine(1.0, 1000.0)
    slow = thinned(log, 300.0)
    assert slow.rate == pytest.approx(300.0, rel=0.12)
    assert len(slow.time) == pytest.approx(3000, abs=2)
    at = np.searchsorted(log.time, slow.time)
    np.testing.assert_array_equal(slow.time, log.time[at])
    np.testing.assert_array_equal(slow.position, log.position[at])
    np.testing.assert_array_equal(slow.velocity, log.velocity[at])
    assert slow.notes[-1] == "thinned from 1000 Hz to 300 Hz"
