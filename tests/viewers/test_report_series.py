"""Curves and clouds: thinned without lying."""

import numpy as np
import pytest

from cdia_pin.viewers.report_series import against, cloud, compact, end_to_end, extremes, over_time


def test_the_curve_of_missing_dry_friction_is_minus_its_level_by_direction(results):
    found = against("velocity", results.given, results.improved, "joint3", 2)
    assert found["curve"] is not None
    speed, torque = (np.array(x) for x in found["curve"])
    assert torque[speed > 0.3] == pytest.approx(-results.level, rel=0.05)
    assert torque[speed < -0.3] == pytest.approx(results.level, rel=0.05)


def test_what_is_no_function_of_a_signal_has_no_curve(results):
    assert against("position", results.given, results.improved, "joint3", 2)["curve"] is None


def test_a_model_that_is_not_improved_has_no_curve(results):
    assert against("velocity", results.given, results.given, "joint3", 2)["curve"] is None
    assert against("velocity", results.given, None, "joint3", 2)["curve"] is None


def test_logs_follow_each_other_in_time(results):
    time, breaks = end_to_end(results.given)
    assert (np.diff(time) > 0).all()
    (second,) = breaks
    assert results.given.time[second] < results.given.time[second - 1]


def test_clouds_hold_no_more_points_than_asked(results):
    thinned = cloud(results.given, results.improved, 0, 50)
    assert {len(x) for x in thinned.values()} <= set(range(25, 51))


def test_clouds_hold_only_samples_that_count(results):
    whole = cloud(results.given, None, 2, 10**6)
    assert len(whole["velocity"]) == results.given.informative[:, 2].sum()


def test_thinning_keeps_peaks():
    signal = np.zeros(10_000)
    signal[1234], signal[8765] = 7.0, -3.0
    kept = extremes([signal], 200)
    assert len(kept) <= 200
    assert {1234, 8765} <= set(kept.tolist())


def test_measured_plus_residual_is_the_model(results):
    series = over_time(results.given, results.improved, 1, 10**6)
    model = np.array(series["measured"]) + np.array(series["before"])
    assert model == pytest.approx(results.given.predicted[:, 1], rel=1e-4, abs=1e-3)


def test_numbers_that_are_not_finite_become_null():
    assert compact([1.234567, np.nan, -np.inf]) == [1.2346, None, None]
