"""Memory of reading and checking: a long log is held once, and little besides."""

import tracemalloc

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from cdia_pin import load_robot
from cdia_pin.logs import Log, check_log, read_log, write_log
from cdia_pin.logs.checks.motion import motion_of
from cdia_pin.logs.derivatives import speed_of
from cdia_pin.logs.readers.parquet import read_parquet

RATE = 1000.0  # [Hz]


@pytest.fixture(scope="module")
def robot():
    return load_robot("panda")


@pytest.fixture(scope="module")
def log(robot):
    time = np.arange(400_000) / RATE
    phase = np.arange(robot.n)
    middle = (robot.limits.lower + robot.limits.upper) / 2
    position = middle + 0.3 * np.sin(2 * np.pi * 0.3 * time[:, None] + phase)
    noise = np.random.default_rng(3).normal(0.0, 0.1, position.shape)
    return Log(robot.joints, time, position, np.cos(5 * position) + noise)


def size(log):
    return log.time.nbytes + log.position.nbytes + log.effort.nbytes


def memory_of_check(log, robot):
    """Most memory that a check takes besides the log [B]."""
    tracemalloc.start()
    check_log(log, robot)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return most


def test_a_check_takes_less_than_half_the_memory_of_the_log(log, robot):
    half = log.slice(0, len(log.time) // 2)
    memory_of_check(half, robot)  # what is imported and compiled
    grown = memory_of_check(log, robot) - memory_of_check(half, robot)
    assert grown < 0.45 * (size(log) - size(half))


def test_a_thinned_motion_does_not_hold_the_signals_of_its_log(log, robot):
    motion = motion_of(log, robot.is_prismatic)
    for signal in (motion.time, motion.q, motion.v, motion.a, motion.effort):
        whole = signal if signal.base is None else signal.base
        assert whole.nbytes < 0.05 * size(log)


def test_a_parquet_file_is_read_beside_its_numbers_in_little_memory(tmp_path):
    rng = np.random.default_rng(0)
    table = pa.table({f"c{k}": rng.normal(size=1_000_000) for k in range(10)})
    parquet.write_table(table, tmp_path / "long.parquet")
    usual, watched = pa.default_memory_pool(), pa.proxy_memory_pool(pa.system_memory_pool())
    pa.set_memory_pool(watched)
    try:
        read = read_parquet(tmp_path / "long.parquet")
    finally:
        pa.set_memory_pool(usual)
    assert read.columns["c9"].tolist() == table["c9"].to_pylist()
    assert 0 < watched.max_memory() < table.nbytes


def test_a_parquet_log_is_held_once_while_it_is_read(robot, log, tmp_path):
    file = write_log(log, tmp_path / "long.parquet")
    read_log(file, robot)  # what is imported
    tracemalloc.start()
    read = read_log(file, robot)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 1.35 * size(log)
    for signal in ("time", "position", "effort"):
        np.testing.assert_array_equal(getattr(read, signal), getattr(log, signal))
    assert read.position.flags.c_contiguous and read.effort.flags.c_contiguous


def test_a_file_of_another_order_is_read_the_same(robot, log, tmp_path):
    table = parquet.read_table(write_log(log.slice(0, 2000), tmp_path / "long.parquet"))
    parquet.write_table(table.select(table.column_names[::-1]), tmp_path / "turned.parquet")
    turned, straight = (read_log(tmp_path / name, robot) for name in ("turned.parquet", "long.parquet"))
    for signal in ("time", "position", "effort"):
        np.testing.assert_array_equal(getattr(turned, signal), getattr(straight, signal))
    assert turned.position.flags.c_contiguous


@pytest.mark.parametrize("even", [True, False])
def test_speeds_are_those_of_numpy_in_less_memory(even):
    rng = np.random.default_rng(0)
    time = np.arange(300_000) if even else np.cumsum(rng.uniform(0.5, 1.5, 300_000))
    position = rng.normal(size=len(time))
    np.testing.assert_array_equal(speed_of(position, time), np.abs(np.gradient(position, time)))
