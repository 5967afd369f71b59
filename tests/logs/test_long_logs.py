"""Long logs: they are read, filtered and looked at in parts, and the parts say what the whole does."""

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import csv, parquet

from cdia_pin import load_robot
from cdia_pin.logs import Log, read_log
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.logs.derivatives import zero_phase
from cdia_pin.logs.filtered_part import Filter, FilteredPart
from cdia_pin.logs.motion_file import motion_document, motion_from
from cdia_pin.logs.readers import dispatch
from cdia_pin.logs.stretches import COUNT, blocks, stretches

RATE, CUTOFF = 250.0, 10.0  # [Hz]
MOST = 600  # compared samples


@pytest.fixture(scope="module")
def scara():
    return load_robot("scara")


@pytest.fixture(scope="module")
def log(scara):
    time = np.arange(0.0, 120.0, 1 / RATE)
    phase = np.arange(scara.n)
    position = 0.1 * np.sin(2 * np.pi * 0.3 * time[:, None] + phase)
    noise = np.random.default_rng(3).normal(0.0, 0.1, position.shape)
    return Log(scara.joints, time, position + 1e-4 * noise, np.cos(5 * position) + noise)


@pytest.mark.parametrize(
    ("count", "most", "multiple"), [(1000, 100, 1), (100_003, 7_000, 7), (2_001, 2_000, 3)]
)
def test_stretches_are_equal_spread_evenly_and_no_more_than_asked(count, most, multiple):
    parts = stretches(count, most, multiple)
    starts = np.array([p.start for p in parts])
    assert len(parts) == COUNT
    assert len({p.stop - p.start for p in parts}) == 1
    assert sum(p.stop - p.start for p in parts) <= most
    assert (starts % multiple == 0).all()
    assert np.ptp(np.diff(starts)) <= multiple
    assert starts[0] == 0
    assert count - multiple < parts[-1].stop <= count


def test_a_short_signal_is_looked_at_whole():
    assert stretches(50, 50) == stretches(50, None) == [slice(0, 50)]


def test_blocks_follow_each_other():
    parts = blocks(slice(30, 1000), 100, 7)
    assert np.concatenate([np.arange(p.start, p.stop) for p in parts]).tolist() == list(range(30, 1000))
    assert {(p.start - 30) % 7 for p in parts} == {0}


def test_a_part_is_filtered_as_the_whole(log):
    by = Filter(CUTOFF, 1.5 * CUTOFF, RATE, 3, 1.0, np.zeros(len(log.joints)))
    part = slice(9_000, 12_000)
    found = FilteredPart.of(log, part, slice(0, len(log.time)), by)
    whole = zero_phase(log.effort, by.motion, RATE)
    assert found.effort == pytest.approx(whole[part][::3], abs=1e-12)


def test_a_stretch_of_a_long_log_is_that_of_the_whole(log, scara):
    whole = condition(log, scara, Conditioning(CUTOFF))
    spread = condition(log, scara, Conditioning(CUTOFF, most=MOST))
    assert len(spread.kept) <= MOST
    assert len(spread.stretches) == COUNT
    assert sum(spread.stretches) == len(spread.time)
    same = np.searchsorted(whole.time, spread.time - 1e-9)
    for signal in ("time", "q", "v", "a", "effort"):
        of_whole = getattr(whole, signal)[same]
        assert getattr(spread, signal) == pytest.approx(of_whole, abs=1e-9 * np.abs(of_whole).max())
    assert spread.speed_noise == pytest.approx(whole.speed_noise, rel=0.3)


def test_no_compared_sample_sees_another_stretch(log, scara):
    spread = condition(log, scara, Conditioning(CUTOFF, most=MOST))
    constant = np.repeat(np.arange(COUNT, dtype=float), spread.stretches)
    assert spread.compared(constant) == pytest.approx(spread.sampled(constant), abs=1e-12)
    assert spread.lengths == np.bincount(spread.sampled(constant).astype(int)).tolist()


def test_the_record_says_how_much_was_looked_at(log, scara):
    spread = condition(log, scara, Conditioning(CUTOFF, most=MOST))
    assert any("20 stretches" in note for note in spread.record["notes"])


def test_a_motion_of_stretches_is_kept_in_a_file(log, scara):
    spread = condition(log, scara, Conditioning(CUTOFF, most=MOST))
    again = motion_from(motion_document(spread))
    assert again.stretches == spread.stretches
    assert again.time == pytest.approx(spread.time, abs=1e-9)
    assert again.kept.tolist() == spread.kept.tolist()


@pytest.mark.parametrize("trim", [0.0, 1.0, 2.0, 8.0])
def test_compared_torques_are_those_of_the_filter(log, scara, trim):
    motion = condition(log, scara, Conditioning(CUTOFF, trim))
    torque = motion.a
    expected = zero_phase(torque, motion.cutoff, motion.rate)[motion.kept]
    assert motion.compared(torque) == pytest.approx(expected, abs=1e-4 * np.abs(expected).max())
    assert motion.compared(torque[:, 0]) == pytest.approx(motion.compared(torque)[:, 0], abs=1e-12)


@pytest.fixture
def table(log):
    columns = {"time": log.time}
    for signal in ("position", "effort"):
        columns |= {f"{signal}.{j}": getattr(log, signal)[:, k] for k, j in enumerate(log.joints)}
    return pa.table({**columns, "count": np.arange(len(log.time))})


def test_parquet_is_read_in_batches(table, log, scara, tmp_path):
    parquet.write_table(table, tmp_path / "log.parquet", row_group_size=1000)
    found = read_log(tmp_path / "log.parquet", scara)
    assert found.position.tolist() == log.position.tolist()
    assert found.time.tolist() == log.time.tolist()


def test_long_plain_text_is_read_in_blocks_as_other_text_is_whole(table, scara, tmp_path, monkeypatch):
    file = tmp_path / "log.csv"
    csv.write_csv(table, file)
    whole = read_log(file, scara)
    monkeypatch.setattr(dispatch, "LONG", 0)
    assert read_log(file, scara).position.tolist() == whole.position.tolist()
    assert read_log(file, scara).notes == whole.notes


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"\n0.4,", b"\n# a comment\n0.4,"),
        (b"\n0.4,", b"\n0.4, "),
        (b"\n0.4,", b"\nfour,"),
        (b"\n0.4,", b"\n0.4,1,"),
    ],
)
def test_text_that_is_not_plain_is_judged_as_a_whole(table, scara, tmp_path, monkeypatch, old, new):
    file = tmp_path / "log.csv"
    csv.write_csv(table, file, csv.WriteOptions(quoting_style="none"))
    file.write_bytes(file.read_bytes().replace(old, new))

    def answer():
        try:
            return read_log(file, scara).effort.tolist()
        except Exception as error:
            return str(error)

    whole = answer()
    monkeypatch.setattr(dispatch, "LONG", 0)
    assert answer() == whole
