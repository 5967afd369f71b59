"""Filters keep what physics needs: constants, ramps, phase; derivatives are those of polynomials."""

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy.signal import butter, filtfilt

from cdia_pin.errors import LogError
from cdia_pin.logs import Log
from cdia_pin.logs.derivatives import uniform, zero_phase


def make_log(time: np.ndarray, position: np.ndarray, effort: np.ndarray | None = None) -> Log:
    effort = np.zeros_like(position) if effort is None else effort
    return Log(("a", "b"), time, position, effort)


def test_zero_phase_is_filtfilt_with_long_odd_padding():
    x = np.cumsum(np.random.default_rng(0).normal(size=(4000, 2)), axis=0)
    b, a = butter(4, 12.0, fs=250.0)
    expected = filtfilt(b, a, x, axis=0, padtype="odd", padlen=3000)
    np.testing.assert_allclose(zero_phase(x, 12.0, 250.0), expected, atol=1e-6)


def test_zero_phase_passes_constants_and_ramps_unchanged():
    x = np.column_stack([np.full(500, 3.0), np.linspace(-2.0, 5.0, 500)])
    np.testing.assert_allclose(zero_phase(x, 5.0, 100.0), x, atol=1e-12)


def test_zero_phase_of_columns_equals_columns_of_zero_phase():
    x = np.random.default_rng(1).normal(size=(301, 3))
    together = zero_phase(x, 8.0, 100.0)
    np.testing.assert_allclose(together[:, 1], zero_phase(x[:, 1], 8.0, 100.0), atol=1e-12)


def test_zero_phase_halves_a_sine_at_the_cutoff_without_shifting_it():
    t = np.arange(10_000) / 1000.0
    sine = np.sin(2 * np.pi * 10.0 * t)
    middle = np.s_[2000:8000]
    np.testing.assert_allclose(zero_phase(sine, 10.0, 1000.0)[middle], 0.5 * sine[middle], atol=1e-3)


@pytest.mark.parametrize("cutoff", [0.0, -1.0, 50.0, 70.0])
def test_zero_phase_refuses_a_cutoff_beyond_half_the_rate(cutoff):
    with pytest.raises(LogError, match="half the sampling rate"):
        zero_phase(np.zeros(100), cutoff, 100.0)


@pytest.mark.parametrize("frequency", [1.0, 5.0, 15.0])
def test_derivatives_have_the_amplitude_of_the_filtered_signal(frequency):
    """Central differences lose 8 % of an acceleration at 10 Hz here, and 18 % at 15 Hz."""
    rate, omega, t = 125.0, 2 * np.pi * frequency, np.arange(4000) / 125.0
    middle, gain = np.s_[1000:3000], 1 / (1 + (np.tan(omega / 2 / rate) / np.tan(np.pi * 20.0 / rate)) ** 8)
    x = np.sin(omega * t) + 3 * t
    slope = zero_phase(x, 20.0, rate, derivative=1)[middle]
    bend = zero_phase(x, 20.0, rate, derivative=2)[middle]
    np.testing.assert_allclose(slope, 3 + gain * omega * np.cos(omega * t[middle]), atol=1e-4 * omega)
    np.testing.assert_allclose(bend, -gain * omega**2 * np.sin(omega * t[middle]), atol=1e-4 * omega**2)


def test_a_ramp_has_its_slope_up_to_the_ends_and_no_acceleration():
    ramp = np.linspace(-2.0, 5.0, 501)
    np.testing.assert_allclose(zero_phase(ramp, 5.0, 100.0, derivative=1), 1.4, atol=1e-10)
    np.testing.assert_allclose(zero_phase(ramp, 5.0, 100.0, derivative=2), 0.0, atol=1e-8)


def test_a_uniform_log_is_returned_unchanged():
    time = 5.0 + np.arange(100) / 125.0
    log = make_log(time, np.random.default_rng(0).normal(size=(100, 2)))
    assert uniform(log) is log


def test_a_jittered_log_is_resampled_to_a_uniform_grid_at_its_median_rate():
    rng = np.random.default_rng(2)
    time = np.cumsum(rng.uniform(0.008, 0.012, 2000))
    motion = np.column_stack([np.sin(time), np.cos(0.5 * time)])
    even = uniform(make_log(time, motion, 10 * motion))
    np.testing.assert_allclose(np.diff(even.time), 1 / even.rate, rtol=1e-9)
    assert even.time[0] == time[0]
    assert even.time[-1] <= time[-1]
    expected = np.column_stack([np.sin(even.time), np.cos(0.5 * even.time)])
    np.testing.assert_allclose(even.position, expected, atol=1e-5)
    np.testing.assert_allclose(even.effort, 10 * expected, atol=1e-3)
    assert "resampled" in even.notes[-1]


def test_held_positions_do_not_overshoot_when_resampled():
    time = np.cumsum(np.random.default_rng(3).uniform(0.5, 1.5, 200)) * 1e-2
    steps = np.repeat(np.random.default_rng(4).normal(size=(50, 2)), 4, axis=0)
    even = uniform(make_log(time, steps))
    assert even.position.max() <= steps.max()
    assert even.position.min() >= steps.min()


def test_a_log_that_is_mostly_gaps_is_refused():
    time = np.concatenate([np.arange(100) * 0.01, 1000.0 + np.arange(100) * 0.01])
    with pytest.raises(LogError, match="gaps"):
        uniform(make_log(time, np.zeros((200, 2))))


@given(
    rate=st.one_of(st.sampled_from([40.0, 100.0, 125.0, 250.0, 500.0, 1000.0]), st.floats(5.0, 5000.0)),
    start=st.floats(-1e6, 1e6),
    count=st.integers(20, 3000),
    dropped=st.lists(st.integers(1, 2998), max_size=40),
)
@settings(max_examples=300, deadline=None)
@example(rate=125.0, start=0.0, count=1000, dropped=[500])
@example(rate=500.0, start=123.456, count=2001, dropped=[7])
def test_rows_may_be_missing_at_any_rate_and_offset_of_the_clock(rate, start, count, dropped):
    kept = np.ones(count, dtype=bool)
    kept[[k for k in dropped if k < count - 1]] = False
    time = (start + np.arange(count) / rate)[kept]
    assume(len(time) > 0.5 * count)  # else another period is the most frequent one
    slope = np.column_stack([time - start, 2.0 - (time - start)])
    even = uniform(Log(("a", "b"), time, slope, slope, slope))
    assert np.isfinite(even.position).all() and np.isfinite(even.effort).all()
    assert even.time[0] == time[0]
    assert time[-1] - 1.01 / even.rate <= even.time[-1] <= time[-1]
    np.testing.assert_allclose(even.position[:, 0], even.time - start, atol=1e-6 / rate + 1e-9)
    np.testing.assert_allclose(even.effort[:, 0], even.time - start, atol=1e-6 / rate + 1e-9)


@pytest.mark.parametrize("count", [2050, 2100, 4100, 20_001])
@pytest.mark.parametrize("shape", [(), (2,)])
def test_a_long_signal_is_filtered_in_blocks_to_the_same_values(monkeypatch, count, shape):
    x = np.cumsum(np.random.default_rng(0).normal(size=(count, *shape)), axis=0)
    whole = zero_phase(x, 25.0, 250.0)
    monkeypatch.setattr("cdia_pin.logs.derivatives.BLOCK", 2049)
    np.testing.assert_allclose(zero_phase(x, 25.0, 250.0), whole, atol=1e-9)
