"""The store: a log is there once, a failure is a row, an interrupted run goes on, and any tool for Parquet reads it."""

import shutil

import numpy as np
import pytest

from cdia_pin.fleet import FleetError, FleetMap, FleetStore, add_logs, addition
from cdia_pin.fleet.columns import COLUMNS
from cdia_pin.fleet.course import courses_of
from tests.fleet.conftest import DAYS, LEVEL


@pytest.fixture(scope="module")
def store(small_fleet, tmp_path_factory):
    store = FleetStore.at(tmp_path_factory.mktemp("s") / "store", make=True)
    added = add_logs(store, FleetMap.read(small_fleet.map))
    assert len(added.added) == DAYS
    assert not added.failed
    return store


def test_a_row_says_what_the_log_says_of_the_model(store):
    rows = [
        r
        for r in store.table().to_pylist()
        if (r["effect"], r["joints"]) == ("coulomb_friction", "joint2") and r["parameter"] == "level"
    ]
    assert len(rows) == DAYS
    for r in rows:
        assert (
            r["ci95_low"]
            <= r["ci95_statistical_low"]
            <= r["value"]
            <= r["ci95_statistical_high"]
            <= r["ci95_high"]
        )
        assert r["ci95_low"] <= LEVEL <= r["ci95_high"]
        assert r["role"] == "usual"
        assert r["recorded_from"] == "name"
        assert r["error"] < r["model_error"]
        assert r["temperature"] == pytest.approx(15.0 + r["recorded"].day)
        assert 0.2 <= r["moving"] <= 1.0


def test_a_log_that_was_added_changes_nothing(store, small_fleet):
    before = store.table()
    again = add_logs(store, FleetMap.read(small_fleet.map))
    assert (again.added, len(again.known)) == ((), DAYS)
    assert store.table().equals(before)


def test_the_same_rows_in_duckdb_pandas_and_arrow(store):
    pandas, duckdb = pytest.importorskip("pandas"), pytest.importorskip("duckdb")
    arrow = store.table(["value"])["value"].drop_null()
    rows = store.folder / "rows"
    frame = pandas.read_parquet(rows)
    assert list(frame.columns) == list(COLUMNS)
    asked = f"select sum(value) from read_parquet('{rows}/*/*.parquet')"
    ((total,),) = duckdb.connect().execute(asked).fetchall()
    assert np.isclose(total, frame["value"].sum())
    assert np.isclose(total, sum(arrow.to_pylist()))


def test_an_interrupted_run_goes_on_and_loses_nothing(small_fleet, tmp_path, monkeypatch):
    store, fleet = FleetStore.at(tmp_path / "store", make=True), FleetMap.read(small_fleet.map)
    rows_of, calls = addition.rows_of, []

    def interrupted(log):
        if len(calls) == 1:
            raise KeyboardInterrupt
        calls.append(log)
        return rows_of(log)

    monkeypatch.setattr(addition, "rows_of", interrupted)
    with pytest.raises(KeyboardInterrupt):
        add_logs(store, fleet)
    monkeypatch.setattr(addition, "rows_of", rows_of)
    rest = add_logs(store, fleet)
    assert (len(rest.known), len(rest.added)) == (1, DAYS - 1)


def test_a_log_that_fails_is_a_row_with_its_reason(small_fleet, tmp_path):
    folder = tmp_path / "arm-1"
    folder.mkdir()
    shutil.copy(small_fleet.logs[0], folder / "good.csv")
    (folder / "bad.csv").write_text("time,position.joint1\n0,0\n", encoding="utf-8")
    shutil.copy(small_fleet.map, tmp_path / "fleet.toml")
    store, fleet = FleetStore.at(tmp_path / "store", make=True), FleetMap.read(tmp_path / "fleet.toml")
    done = add_logs(store, fleet)
    assert list(done.failed) == ["bad.csv"]
    assert done.added == ("good.csv",)
    rows = [r for r in store.table().to_pylist() if r["failure"]]
    assert [r["log"] for r in rows] == ["bad.csv"]
    assert rows[0]["effect"] is None
    assert add_logs(store, fleet).failed == {}
    assert list(add_logs(store, fleet, retry=True).failed) == ["bad.csv"]


def test_logs_of_one_name_are_told_apart(small_fleet, tmp_path):
    bad = "time,position.joint1\n0,{}\n"
    for day, log in enumerate(small_fleet.logs[:2], start=12):
        folder = tmp_path / f"2026-05-{day}"
        folder.mkdir()
        shutil.copy(log, folder / "run.csv")
        (folder / "bad.csv").write_text(bad.format(day), encoding="utf-8")
    (tmp_path / "fleet.toml").write_text(
        '[robots.a]\nrobot = "scara"\nlogs = ["*/*.csv"]\n', encoding="utf-8"
    )
    store, fleet = FleetStore.at(tmp_path / "store", make=True), FleetMap.read(tmp_path / "fleet.toml")
    done = add_logs(store, fleet)
    assert (len(done.added), len(done.failed)) == (2, 2)
    (robot,) = courses_of(store)
    assert (robot.logs, len(robot.failed), robot.dated, robot.days) == (4, 2, True, 1.0)
    assert {len(c.logs) for c in robot.courses} == {2}
    assert [at.day for at in robot.courses[0].recorded] == [12, 13]


def test_another_version_fits_the_logs_again(small_fleet, tmp_path):
    text = small_fleet.map.read_text(encoding="utf-8").replace("arm-1/*.csv", str(small_fleet.logs[0]))
    (tmp_path / "fleet.toml").write_text(text, encoding="utf-8")
    store, fleet = FleetStore.at(tmp_path / "store", make=True), FleetMap.read(tmp_path / "fleet.toml")
    add_logs(store, fleet)
    (file,) = store.folder.glob("rows/*/*.parquet")
    file.rename(store.file_of("arm-1", *file.stem.split("-")[:2], "0.0"))
    assert len(add_logs(store, fleet).added) == 1


def test_a_folder_that_is_no_store(tmp_path):
    with pytest.raises(FleetError, match="no store"):
        FleetStore.at(tmp_path)
    (tmp_path / "x").touch()
    with pytest.raises(FleetError, match="not empty"):
        FleetStore.at(tmp_path, make=True)
    (tmp_path / "cdia-fleet.json").write_text('{"schema": "cdia-fleet/99"}', encoding="utf-8")
    with pytest.raises(FleetError, match="cdia-fleet/99"):
        FleetStore.at(tmp_path)
