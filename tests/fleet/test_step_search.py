"""A step is found, a temperature is none, one bad log is none, and chance gives as many alarms as was stated."""

import numpy as np
import pytest

from cdia_pin.fleet.alarm_limit import FEWEST_AFTER, alarm_limit, run_length
from cdia_pin.fleet.onset import find_onset
from cdia_pin.fleet.robust_fit import robust_fit
from cdia_pin.fleet.step_search import FEWEST_BEFORE, find_step, find_steps

COUNT = 60
STATED = np.full(COUNT, 0.5)
ONE = np.ones((COUNT, 1))
USUAL_LIMIT = alarm_limit(365.25 * 27 / 0.1)  # daily logs, 27 parameters, 0.1 false alarms a year


def noise(seed):
    return np.random.default_rng(seed).standard_normal(COUNT)


def test_a_step_is_found_where_it_is_with_its_size():
    inside = 0
    for seed in range(40):
        values = noise(seed)
        values[35:] += 4.0
        step = find_step(values, STATED, ONE)
        assert abs(step.at - 35) <= 2
        assert abs(step.z) > 6
        inside += abs(step.size - 4.0) <= 1.96 * step.deviation
    assert inside >= 34  # of 95 % intervals


@pytest.mark.parametrize("error", [5.0, 50.0, 5000.0])
def test_one_bad_log_is_no_alarm_however_bad(error):
    for seed in range(20):
        values = noise(seed)
        values[-1] += error
        assert abs(find_step(values, STATED, ONE).z) < USUAL_LIMIT


def test_what_the_temperature_does_is_no_step():
    warm = 27 + 8 * np.tanh((np.arange(COUNT) - 30) / 6) + noise(1)  # [°C], summer comes
    values = 10.0 - 0.3 * warm + 0.3 * noise(2)
    columns = np.column_stack([ONE, warm - warm.mean()])
    with_it, without = find_step(values, STATED, columns), find_step(values, STATED, ONE)
    assert abs(with_it.z) < USUAL_LIMIT < abs(without.z)
    fit = robust_fit(values, STATED, columns)
    assert fit.coefficients[1] == pytest.approx(-0.3, abs=3 * fit.deviations[1])


def test_few_logs_are_not_judged():
    assert find_step(np.zeros(6), np.ones(6), np.ones((6, 1))) is None


def test_the_units_of_the_values_do_not_matter():
    values = noise(3)
    values[40:] += 2
    one, thousand = (find_step(k * values, k * STATED, ONE) for k in (1.0, 1000.0))
    assert thousand.z == pytest.approx(one.z, rel=1e-6)
    assert thousand.size == pytest.approx(1000 * one.size, rel=1e-6)


def test_the_limit_gives_the_stated_rate_of_false_alarms():
    """Steps of known noise in a window of 365 logs, by cumulated sums; the formula is an approximation."""
    rng, logs, mean = np.random.default_rng(0), 365, 1000.0
    sums = np.cumsum(rng.standard_normal((1500, logs)), axis=1)
    passed = np.zeros(len(sums), bool)
    limit = alarm_limit(mean)
    for n in range(FEWEST_BEFORE + FEWEST_AFTER, logs + 1):
        before = np.arange(FEWEST_BEFORE, n - FEWEST_AFTER + 1)
        after = sums[:, n - 1, None] - sums[:, before - 1]
        share = (n - before) / n
        z = (after - share * sums[:, n - 1, None]) / np.sqrt((n - before) * (1 - share))
        passed |= np.abs(z).max(axis=1) > limit
    expected = 1 - np.exp(-logs / mean)
    assert 0.6 * expected < passed.mean() < 1.15 * expected
    assert run_length(limit) == pytest.approx(mean, rel=1e-3)


def test_noise_of_long_tails_gives_no_more_false_alarms_than_stated():
    """Of 700 courses, 7 alarms are stated; 20 came before the few logs after a step counted as few."""
    rng, courses, share = np.random.default_rng(9), 700, 0.01
    limit = alarm_limit(COUNT / share)
    alarms = 0
    for _ in range(courses):
        steps = find_steps(rng.standard_t(3, COUNT), 1e-3 * STATED, ONE, range(COUNT + 1))
        alarms += max(abs(step.z) for step in steps.values()) > limit
    assert alarms <= 12  # 4 % by chance at the stated rate


@pytest.mark.parametrize("size", [4.0, 40.0])
def test_the_interval_of_a_growth_holds_its_size(size):
    """Where it began and how long it took are not known: 3 of 10 intervals held large sizes before that counted."""
    inside = 0
    for seed in range(60):
        growth = size * np.clip((np.arange(COUNT) - 24) / 20, 0, 1)
        onset = find_onset(noise(seed) + growth, 1e-3 * STATED, ONE)
        inside += abs(onset.size - size) < 1.96 * onset.deviation
    assert inside >= 53  # of 95 % intervals


def test_a_growth_is_told_from_a_step():
    values = 0.3 * noise(4)
    values += 3.0 * np.clip((np.arange(COUNT) - 20) / 20, 0, 1)
    grown = find_onset(values, STATED, ONE)
    assert 10 <= grown.logs <= 35
    assert abs(grown.at - 20) <= 6
    assert grown.size == pytest.approx(3.0, abs=3 * grown.deviation)
    values = 0.3 * noise(5)
    values[30:] += 3.0
    stepped = find_onset(values, STATED, ONE)
    assert (stepped.at, stepped.logs) == (30, 1)


def test_a_course_as_it_was_after_each_log_is_judged_as_if_it_ended_there():
    values, deviations = noise(6), 0.5 + 0.1 * np.abs(noise(7))
    values[30:] += 2.0
    columns = np.column_stack([ONE, noise(8)])
    counts = range(1, COUNT + 1)
    found = find_steps(values, deviations, columns, counts)
    alone = {n: find_step(values[:n], deviations[:n], columns[:n]) for n in counts}
    assert list(found) == [n for n, step in alone.items() if step is not None]
    for n, step in found.items():
        assert (step.at, step.z) == (alone[n].at, pytest.approx(alone[n].z, rel=1e-9))
        assert (step.size, step.deviation) == pytest.approx((alone[n].size, alone[n].deviation), rel=1e-9)
