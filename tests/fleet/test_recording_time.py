"""When a log was recorded: the map counts before the log's clock, and that before its name."""

from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest

from cdia_pin import load_robot, read_log, write_log
from cdia_pin.fleet.recording_time import TimeSource, recording_time
from tests.made_logs import make


@pytest.mark.parametrize(
    ("name", "at"),
    [
        ("2026-05-12.csv", (2026, 5, 12)),
        ("cell3_20260512_143005.parquet", (2026, 5, 12, 14, 30, 5)),
        ("run 2026_05_12T14-30.db3", (2026, 5, 12, 14, 30)),
        ("2026-02-31.csv", None),
        ("serial120260512345.csv", None),
        ("fourier_50s.csv", None),
    ],
)
def test_the_date_of_a_name(name, at):
    found = recording_time(None, name)
    assert found.at == (None if at is None else datetime(*at, tzinfo=UTC))
    assert found.source is (TimeSource.ABSENT if at is None else TimeSource.NAME)


def test_the_clock_of_a_log_and_the_map(tmp_path):
    robot = load_robot("scara")
    began = datetime(2026, 5, 12, 14, 30, tzinfo=UTC)
    log = make(robot, duration=4.0).log
    path = write_log(replace(log, time=log.time + began.timestamp()), tmp_path / "2020-01-01.csv")
    read = read_log(path, robot)
    assert read.recorded == pytest.approx(began.timestamp(), abs=1e-3)
    assert recording_time(read, path.name).source is TimeSource.LOG
    assert recording_time(read, path.name, datetime(2026, 6, 1)).at == datetime(2026, 6, 1, tzinfo=UTC)
    assert read_log(write_log(log, tmp_path / "b.csv"), robot).recorded is None
    assert np.isclose(read.time[0], 0.0)


@pytest.mark.parametrize(
    ("name", "folders", "day"),
    [
        ("run.csv", ("2026-05-12",), 12),
        ("run.csv", ("2026-05-12", "2026-05-13_night", "bag"), 13),  # the nearest one
        ("2026-05-14.csv", ("2026-05-12",), 14),
        ("run.csv", ("2026", "05", "12"), 12),
        ("run.csv", ("2026", "05", "32"), None),
        ("run.csv", ("cell-3",), None),
    ],
)
def test_the_date_of_a_folder_counts_where_the_name_has_none(name, folders, day):
    found = recording_time(None, name, folders=folders)
    assert found.at == (None if day is None else datetime(2026, 5, day, tzinfo=UTC))
