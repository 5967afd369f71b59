"""``cdia fleet`` and ``cdia trend``: a store from a map, and what changes in it."""

import json

import numpy as np
import pytest

from cdia_pin import load_robot, write_log
from tests.made_logs import make


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fleet")
    log = make(load_robot("scara"), lambda q, v, a: -0.5 * np.sign(v), duration=12.0, noise=0.02).log
    write_log(log, folder / "2026-05-12.csv")
    (folder / "fleet.toml").write_text('[robots.arm]\nrobot = "scara"\nlogs = ["*.csv"]\n', encoding="utf-8")
    return folder


def test_logs_are_added_once_and_shown(cdia, folder):
    store = folder / "store"
    first = cdia("fleet", "add", "--robots", folder / "fleet.toml", "--store", store)
    assert first.code == 0
    assert "1 log added, 0 were there already, 0 failed" in first.out
    again = cdia(
        "fleet", "add", folder / "2026-05-12.csv", "--robots", folder / "fleet.toml", "--store", store
    )
    assert "0 logs added, 1 was there already" in again.out
    shown = cdia("fleet", "show", store, "--json", "-")
    assert shown.json["robots"][0]["logs"] == 1
    assert shown.json["schema"] == "cdia-fleet/1"


def test_a_trend_of_one_log_says_what_is_missing(cdia, folder, tmp_path):
    store = tmp_path / "store"
    cdia("fleet", "add", "--robots", folder / "fleet.toml", "--store", store)
    report, metrics, document = tmp_path / "t.html", tmp_path / "t.prom", tmp_path / "t.json"
    outcome = cdia("trend", store, "--report", report, "--prometheus", metrics, "--json", document)
    assert outcome.code == 0
    assert "an alarm needs more than 8" in " ".join(outcome.out.split())
    assert report.read_text(encoding="utf-8").startswith("<!doctype html>")
    assert 'cdia_robot_logs{robot="arm"} 1' in metrics.read_text(encoding="utf-8")
    assert json.loads(document.read_text(encoding="utf-8"))["changes"] == []


def test_what_is_missing_is_said(cdia, folder, tmp_path):
    assert "needs the map and the store" in cdia("fleet", "add").error
    assert "no store of a fleet" in cdia("trend", tmp_path).error
    assert (
        "of no robot"
        in cdia(
            "fleet",
            "add",
            folder / "fleet.toml",
            "--robots",
            folder / "fleet.toml",
            "--store",
            tmp_path / "s",
        ).error
    )
