"""Blocks of time: every sample in one, and what a motion repeats with its repeats."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.time_blocks import distinct_time, in_half, time_blocks, within
from tests.made_logs import CUTOFF, conditioned, make

BLOCKS = 8
PERIOD = 6.0  # [s]


@pytest.fixture(scope="module")
def pendulum():
    return load_robot("double_pendulum")


def segments(robot, *durations):
    """Logs of a motion that repeats after six seconds, of some durations."""
    made = []
    for k, duration in enumerate(durations):
        log = make(robot, duration=duration).log
        phase = 2 * np.pi * log.time[:, None] / PERIOD
        q = np.column_stack([np.sin(phase) + 0.4 * np.cos(2 * phase), 0.7 * np.cos(phase + k)])
        made.append(conditioned(robot, replace(make(robot, duration=duration), log=replace(log, position=q))))
    return Experiment.of(robot, made).segments


def members(blocks, count):
    return [np.arange(count)[b] for b in blocks]


@pytest.mark.parametrize("durations", [(20.0,), (20.0, 5.0), (13.0, 25.0)])
def test_every_sample_is_in_one_block(pendulum, durations):
    given = segments(pendulum, *durations)
    count = sum(len(s.measured) for s in given)
    inside = members(time_blocks(given, BLOCKS), count)
    assert sorted(np.concatenate(inside)) == list(range(count))
    assert len(inside) == BLOCKS


def test_what_is_driven_again_is_in_the_same_block(pendulum):
    (log,) = segments(pendulum, 20.0)
    count = len(log.measured)
    number = np.empty(count, int)
    for b, inside in enumerate(members(time_blocks([log], BLOCKS), count)):
        number[inside] = b
    time = log.motion.time[log.motion.kept]
    assert log.distinct * (time[1] - time[0]) == pytest.approx(PERIOD, abs=0.1)
    later = number[log.distinct :]
    assert np.array_equal(later, number[: len(later)])


def test_a_motion_that_is_driven_once_has_contiguous_blocks(pendulum):
    log = Experiment.of(pendulum, [conditioned(pendulum, make(pendulum, seed=3))]).segments[0]
    blocks = time_blocks([log], BLOCKS, first=100)
    assert all(isinstance(b, slice) for b in blocks)
    assert [b.start for b in blocks[1:]] == [b.stop for b in blocks[:-1]]
    assert (blocks[0].start, blocks[-1].stop) == (100, 100 + len(log.measured))


def test_halves_hold_a_half_of_every_log_and_all_samples_once(pendulum):
    given = segments(pendulum, 20.0, 5.0)
    count, first = sum(len(s.measured) for s in given), len(given[0].measured)
    halves = [
        np.concatenate(members(within(time_blocks(given, BLOCKS), in_half(given, k)), count)) for k in (0, 1)
    ]
    assert sorted(np.concatenate(halves)) == list(range(count))
    for half in halves:
        assert 0.4 < np.sum(half < first) / first < 0.6
        assert 0.4 < np.sum(half >= first) / (count - first) < 0.6


def test_a_motion_that_two_logs_drive_is_in_the_same_blocks(pendulum):
    made = make(pendulum, duration=20.0)
    late = replace(made.log, time=made.log.time, position=np.roll(made.log.position, -200, axis=0)).slice(
        0, 1750
    )
    other = make(pendulum, seed=9, duration=20.0)
    logs = [made, replace(made, log=late), other]
    given = Experiment.of(pendulum, [conditioned(pendulum, m) for m in logs]).segments
    assert given[1].lag_behind(given[0]) == pytest.approx(200 / made.log.rate, abs=0.2)
    assert given[2].lag_behind(given[0]) is None
    count = sum(len(s.measured) for s in given)
    blocks = members(time_blocks(given, BLOCKS), count)
    assert sorted(np.concatenate(blocks)) == list(range(count))
    number = np.empty(count, int)
    for b, inside in enumerate(blocks):
        number[inside] = b
    first, second, third = np.split(number, np.cumsum([len(s.measured) for s in given])[:-1])
    lag = round(given[1].lag_behind(given[0]) / given[0].pace)
    shared = min(len(second), len(first) - lag)
    np.testing.assert_array_equal(second[:shared], first[lag : lag + shared])
    assert set(first) & set(third) <= {first.max()}
    assert distinct_time(given) < 0.75 * sum(np.ptp(s.motion.time) for s in given)


def test_a_pause_of_a_log_is_no_time_of_its_motion(pendulum):
    log = make(pendulum, duration=20.0).log
    paused = replace(log, time=log.time + np.where(log.time < 10.0, 0.0, 30.0))
    for whole, parts in ((log, 1), (paused, 2)):
        (segment,) = Experiment.of(pendulum, [condition(whole, pendulum, CUTOFF)]).segments
        assert len(segment.motion.stretches or [0]) == parts
        assert distinct_time([segment]) == pytest.approx(20.0, abs=0.1)


def test_a_motion_is_the_same_at_another_cutoff(pendulum):
    log = make(pendulum, duration=20.0).log
    motions = [condition(log, pendulum, Conditioning(cutoff=cutoff)) for cutoff in (2.0, 5.0)]
    slow, quick = Experiment.of(pendulum, motions).segments
    assert slow.pace > 1.5 * quick.pace
    assert quick.lag_behind(slow) == pytest.approx(0.0, abs=slow.motion.record["trim"] / slow.motion.cutoff)
