"""Healthy motion is cut into two halves of equal length, in few pieces."""

import numpy as np
import pytest

from cdia_pin.diagnosis.healthy_part import halves
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.residuals import least_piece
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
