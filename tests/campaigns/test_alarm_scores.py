"""Thresholds and intervals: laws of the counting, and values from the textbooks."""

import numpy as np
import pytest

from cdia_pin.campaigns.alarm_scores import FACTORS, alarms, scores, sustained
from cdia_pin.campaigns.alarm_tail import AlarmTail
from cdia_pin.campaigns.estimates import median, rate, share
from cdia_pin.campaigns.run_row import RunRow
from cdia_pin.errors import CdiaError


@pytest.mark.parametrize("ticks", [1, 2, 3, 4, 7])
def test_what_is_sustained_is_the_least_of_the_last_ticks(ticks):
    ratio = np.random.default_rng(0).random((40, 3))
    wanted = [
        [ratio[k - ticks + 1 : k + 1, j].min() if k >= ticks - 1 else 0 for j in range(3)] for k in range(40)
    ]
    np.testing.assert_array_equal(sustained(ratio, ticks), wanted)


def test_a_higher_threshold_is_crossed_later_and_a_spike_shorter_than_the_debounce_never():
    time = np.arange(0.0, 10.0, 0.01)
    ratio = np.zeros((len(time), 2))
    ratio[time >= 6, 1] = (time[time >= 6] - 6) * 2  # grows from the onset on
    ratio[300, 0] = 50.0  # one tick
    found = scores(ratio, time, 2, 6.0, np.array([False, True]))
    assert max(found.peaks) == 0.0
    assert len(found.peaks) == 5  # seconds 1 to 6
    reached = np.array([d for d in found.delays if np.isfinite(d)])
    assert (np.diff(reached) > 0).all()
    np.testing.assert_allclose(reached, np.array(FACTORS[: len(reached)]) / 2, atol=0.021)
    assert max(scores(ratio, time, 1, 6.0, np.array([False, True])).peaks) == 50.0


def test_seconds_in_a_row_are_one_alarm():
    assert alarms(np.array([0.1, 2.0, 3.0, 0.2, 1.5]), 1.0) == 2
    assert alarms(np.array([]), 1.0) == 0


def test_intervals_are_those_of_the_textbooks():
    none = share(0, 10)  # Clopper–Pearson: 1 − 0.025^(1/10)
    assert (none.value, none.lower, none.upper) == pytest.approx((0.0, 0.0, 1 - 0.025**0.1))
    assert share(7, 10).lower == pytest.approx(0.3475, abs=1e-4)
    quiet = rate(0, 2.0)  # of a Poisson process: −ln 0.025 over the time
    assert (quiet.value, quiet.upper) == pytest.approx((0.0, -np.log(0.025) / 2))
    assert rate(3, 1.0).lower == pytest.approx(0.6187, abs=1e-4)
    assert np.isnan(share(0, 0).value) and np.isnan(rate(0, 0.0).value)


def test_a_median_counts_what_never_came_and_resamples_whole_arms():
    values, arms = [1.0, 2.0, 3.0, np.inf, np.inf, np.nan], list(range(6))
    found = median(values, arms)
    assert (found.value, found.count, found.upper) == (3.0, 5, np.inf)
    data = np.random.default_rng(1).normal(size=300)
    alone, groups = median(data, range(300)), median(np.repeat(data[:30], 10), np.repeat(range(30), 10))
    assert alone.lower < 0 < alone.upper
    assert groups.upper - groups.lower > 2 * (alone.upper - alone.lower)


def tail_of(draw, arms=50, seconds=400):
    rng = np.random.default_rng(2)
    empty = RunRow(0, "ur5", 0.0, 0.0, "", 0, 0, "", "", "", 0.0)
    from dataclasses import replace

    return AlarmTail.of([replace(empty, arm_seed=k, peaks=tuple(draw(rng, seconds))) for k in range(arms)])


def test_a_tail_holds_its_rate_also_where_it_is_extrapolated():
    tail = tail_of(lambda rng, count: rng.exponential(0.1, count))
    assert tail.hours == pytest.approx(50 * 400 / 3600)
    for alarms_per_hour in (360.0, 36.0, 0.36, 0.0036):
        true = -0.1 * np.log(alarms_per_hour / 3600)
        assert true <= tail.factor(alarms_per_hour) < 1.15 * true
    assert tail.is_extrapolated(0.1) and not tail.is_extrapolated(1.0)


def test_too_few_seconds_make_no_threshold():
    with pytest.raises(CdiaError, match="40 healthy seconds are too few for a threshold, 400 are needed"):
        tail_of(lambda rng, count: rng.random(count), arms=2, seconds=20)
