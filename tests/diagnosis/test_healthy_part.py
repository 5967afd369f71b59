"""Which part of a log is taken as healthy, and how healthy motion is cut into halves."""

import numpy as np
import pytest

from cdia_pin.diagnosis.healthy_part import halves, motion, parted
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.residuals import least_piece
from cdia_pin.errors import LogError
from cdia_pin.logs import Log

RATE = 100.0
LEAST = least_piece(MonitorSettings())


def run(duration: float) -> Log:
    time = np.arange(round(duration * RATE) + 1) / RATE
    return Log(("a",), time, np.sin(time)[:, None], np.cos(time)[:, None])


@pytest.mark.parametrize(
    "durations", [[2], [3.5], [20], [60, 60], [1, 1], [1.5] * 3, [10, 2, 3], [1, 40], [0.5] * 5]
)
def test_both_halves_hold_motion_and_nothing_is_lost(durations):
    runs = [run(d) for d in durations]
    first, second = halves(runs, LEAST)
    assert first
    assert second
    assert sum(len(r.time) for r in first + second) == sum(len(r.time) for r in runs)
    lengths = [sum(r.duration for r in half) for half in (first, second)]
    assert abs(lengths[0] - lengths[1]) <= 2 * LEAST + 2 / RATE


def test_at_most_one_run_is_cut():
    runs = [run(10), run(2), run(3)]
    first, second = halves(runs, LEAST)
    assert [len(first), len(second)] == [1, 3]
    assert second[1:] == tuple(runs[1:])


def test_runs_of_one_length_are_not_cut():
    runs = [run(60), run(60)]
    assert halves(runs, LEAST) == ((runs[0],), (runs[1],))


def after_rest(rest: float, motion: float, velocity: bool = True) -> Log:
    """A log of an arm that rests before it moves, with the noise of an encoder."""
    time = np.arange(round((rest + motion) * RATE) + 1) / RATE
    moving = np.maximum(time - rest, 0.0)
    noise = 1e-5 * np.random.default_rng(1).standard_normal(time.shape)
    position = 0.3 * (1 - np.cos(moving)) + noise
    return Log(
        ("a",),
        time,
        position[:, None],
        np.cos(time)[:, None],
        (0.3 * np.sin(moving))[:, None] if velocity else None,
    )


@pytest.mark.parametrize("velocity", [True, False])
@pytest.mark.parametrize(
    ("rest", "motion", "healthy"), [(0, 30, 9.0), (9, 30, 9.0), (60, 10, 5.0), (5, 200, 20.0)]
)
def test_the_healthy_part_is_counted_in_motion(rest, motion, healthy, velocity):
    log = after_rest(rest, motion, velocity)
    first, second = parted(log)
    assert first.duration == pytest.approx(rest + healthy, abs=0.7)  # it sets off and turns round slowly
    assert len(first.time) + len(second.time) == len(log.time)
    assert parted(log, 7.0)[0].duration == pytest.approx(7.0, abs=0.02)


@pytest.mark.parametrize(("rest", "motion"), [(0, 3), (20, 3), (30, 0)])
def test_of_a_log_with_little_motion_healthy_runs_are_asked_for(rest, motion):
    with pytest.raises(LogError, match="--healthy"):
        parted(after_rest(rest, motion))


@pytest.mark.parametrize("step", [0.0, 1e-4])
@pytest.mark.parametrize("speed", [0.05, 0.5])
def test_a_slow_arm_with_rough_sensors_moves_and_an_encoder_that_flickers_rests(speed, step):
    rng = np.random.default_rng(2)
    time = np.arange(6000) / RATE
    travel = 0.3 * np.sin(speed / 0.3 * time) + 1e-5 * rng.standard_normal(time.shape)
    flicker = step * (rng.random(time.shape) < 0.2)
    position = np.column_stack([travel, flicker])
    velocity = 0.02 * rng.standard_normal(position.shape) + [speed, 0.0]
    log = Log(("a", "b"), time, position, np.zeros_like(position), velocity)
    first, _ = parted(log)
    assert first.duration == pytest.approx(18.0, abs=2.0)
    assert not motion(log)[:, 1].any()


def test_a_log_of_a_few_samples_is_refused():
    with pytest.raises(LogError, match="--healthy"):
        parted(after_rest(0, 10).slice(0, 3))
