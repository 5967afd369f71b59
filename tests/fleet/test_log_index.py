"""The index of hashes: a log is not read again while nothing about its files has changed, and in doubt it is."""

import os
import time

import pytest

from cdia_pin.fleet import log_index
from cdia_pin.fleet.log_index import INDEX, LogIndex


@pytest.fixture
def read(monkeypatch):
    """The logs that were read, one entry for each time."""
    out, hashed = [], log_index.sha256_of
    monkeypatch.setattr(log_index, "sha256_of", lambda files: out.append(files) or hashed(files))
    return out


@pytest.fixture
def later(monkeypatch):
    """The clock is a minute ahead of the files, as it is in the next night."""
    now = time.time
    monkeypatch.setattr(log_index.time, "time", lambda: now() + 60)


def hashed(folder, log):
    index = LogIndex(folder)
    found = index.sha256_of(log)
    index.write()
    return found


@pytest.mark.usefixtures("later")
@pytest.mark.parametrize("is_folder", [False, True])
def test_a_log_that_has_not_changed_is_read_once(tmp_path, read, is_folder):
    log = file = tmp_path / "log"
    if is_folder:
        log.mkdir()
        file = log / "part.db3"
    file.write_text("one")
    assert hashed(tmp_path, log) == hashed(tmp_path, log)
    assert len(read) == 1
    if is_folder:
        (log / "metadata.yaml").write_text("two")
        hashed(tmp_path, log)
        assert len(read) == 2


@pytest.mark.usefixtures("later")
def test_other_bytes_of_the_same_size_and_time_are_another_log(tmp_path, read):
    log = tmp_path / "log.csv"
    log.write_text("one")
    first, times = hashed(tmp_path, log), (log.stat().st_atime_ns, log.stat().st_mtime_ns)
    time.sleep(0.05)  # the clock of a file system ticks some hundred times a second
    log.write_text("two")
    os.utime(log, ns=times)
    assert hashed(tmp_path, log) != first
    other = tmp_path / "other"
    other.write_text("six")
    os.utime(other, ns=times)
    other.replace(log)
    assert len({first, hashed(tmp_path, log)}) == 2
    assert len(read) == 3


def test_the_hash_of_a_log_that_was_written_a_moment_ago_is_not_kept(tmp_path, read):
    log = tmp_path / "log.csv"
    log.write_text("one")
    assert hashed(tmp_path, log) == hashed(tmp_path, log)
    assert len(read) == 2


@pytest.mark.usefixtures("later")
@pytest.mark.parametrize("text", ["", "[]", "{", '{"a": 1}', '{"a": [[], ""]}', '{"a": [[], null]}'])
def test_a_damaged_index_costs_time_and_no_log(tmp_path, text):
    log = tmp_path / "log.csv"
    log.write_text("one")
    whole = hashed(tmp_path, log)
    (tmp_path / INDEX).write_text(text)
    assert hashed(tmp_path, log) == whole
    (tmp_path / INDEX).unlink()
    (tmp_path / INDEX).mkdir()
    assert hashed(tmp_path, log) == whole
