"""The trend of a store: what changed is named with its size and day, on the right robot, beyond temperature."""

from __future__ import annotations

import json
import re
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from cdia_pin.errors import CdiaError
from cdia_pin.fleet import FleetStore, TrendSettings, fleet_trend, prometheus_text, trend_document
from cdia_pin.fleet.columns import COLUMNS
from cdia_pin.fleet.prometheus import METRICS
from cdia_pin.plain_json import plain
from cdia_pin.viewers.trend_report import trend_page
from cdia_pin.viewers.trend_words import change_sentence, trend_answer

ROOT = Path(__file__).resolve().parents[2]
DAYS, CHANGE = 50, 30
FIRST = datetime(2026, 4, 12, 6, tzinfo=UTC)
JOINTS = ("elbow", "wrist")


def rows(robot: str, day: int, rng: np.random.Generator) -> list[dict[str, object]]:
    """Rows of one day: friction that falls with temperature, and on one robot's elbow grows by 18 % from a day on."""
    warm = 25 + 8 * np.sin(day / 8) + rng.normal(0, 1)
    head = dict.fromkeys(COLUMNS) | {
        "robot": robot, "log": f"{day:03d}.csv", "sha256": f"{day:020d}".ljust(64, "0"), "setup": "0" * 64,
        "recorded": FIRST + timedelta(days=day), "added": FIRST, "effect": "coulomb_friction", "parameter": "level",
        "unit": "N·m", "role": "model", "model_value": 5.0, "temperature": warm, "load": 20 + rng.normal(0, 3),
        "speed": 0.5, "recorded_from": "map",
    }  # fmt: skip
    out = []
    for joint in JOINTS:
        worn = 0.9 if (robot, joint) == ("b", "elbow") and day >= CHANGE else 0.0
        value = 5.0 * np.exp(-0.02 * (warm - 25)) + worn + 0.05 * rng.standard_normal()
        ends = {"ci95_low": value - 0.2, "ci95_high": value + 0.2}
        own = {"ci95_statistical_low": value - 0.1, "ci95_statistical_high": value + 0.1}
        out.append(head | {"joints": joint, "value": value} | ends | own)
    out[1]["speed"] = 2.0 if day == 5 else 0.5  # another motion
    return out


def stored(folder: Path, altered=lambda row, day: row) -> FleetStore:
    """A store of three robots, with rows that a function alters."""
    store = FleetStore.at(folder / "store", make=True)
    for k, robot in enumerate("abc"):
        rng = np.random.default_rng(k)
        for day in range(DAYS):
            store.write([altered(row, day) for row in rows(robot, day, rng)])
    return store


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    return stored(tmp_path_factory.mktemp("trend"))


@pytest.fixture(scope="module")
def trend(store):
    return fleet_trend(store)


def test_the_worn_joint_is_named_with_size_and_day(trend):
    (change,) = trend.changes
    assert (change.trend.course.robot, change.trend.course.joints) == ("b", ("elbow",))
    assert change.alarm.growth == pytest.approx(0.18, abs=0.02)
    assert abs((change.alarm.since_time - FIRST).days - CHANGE) <= 1
    assert change.alarm.raised_time >= change.alarm.since_time
    sentence = change_sentence(change).replace("\N{NO-BREAK SPACE}", " ")
    assert re.match(
        r"coulomb friction of elbow: \+1\d\.\d ± \d\.\d % beyond temperature and load since 1\d May 2026",
        sentence,
    )


def test_without_the_temperature_other_joints_change_too(store):
    bare = fleet_trend(store, TrendSettings(regressors=False))
    assert len([t for r in bare.robots for t in r.trends if t.alarm]) > 1


def test_a_log_of_another_motion_is_said_not_to_be_comparable(trend):
    wrist = next(t.course for t in trend.robots[0].trends if t.course.joints == ("wrist",))
    assert [why for why in wrist.not_comparable if why] == ["the joint moves at other speeds"]


def test_the_answer_is_five_lines(trend):
    answer = trend_answer(trend)
    assert len(answer) == 5
    assert answer[0][0] == "1 of 3 robots changed"


def test_json_holds_the_courses_and_the_change(trend):
    document = json.loads(json.dumps(plain(trend_document(trend)), allow_nan=False))
    assert document["schema"] == "cdia-trend/1"
    assert document["changes"][0]["joints"] == ["elbow"]
    assert len(document["robots"][0]["courses"][0]["value"]) == DAYS


def test_the_metrics_follow_the_text_format(trend):
    text = prometheus_text(trend)
    assert text.endswith("\n")
    sample = re.compile(r'[a-z_]+\{[a-z]+="[^"\n]*"(,[a-z]+="[^"\n]*")*\} -?[0-9.e+-]+')
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    assert all(sample.fullmatch(line) for line in lines)
    assert any(line.startswith('cdia_change_size{robot="b"') for line in lines)


def test_the_dashboard_asks_for_metrics_that_there_are():
    board = json.loads((ROOT / "examples" / "grafana" / "cdia_fleet.json").read_text(encoding="utf-8"))
    asked = " ".join(target["expr"] for panel in board["panels"] for target in panel["targets"])
    assert set(re.findall(r"cdia_\w+", asked)) <= set(METRICS)


def test_the_report_is_one_file_without_network(trend):
    page = trend_page(trend, "cdia trend store")
    assert "<svg" in page
    assert "http://" not in page.replace("http://www.w3.org", "")
    assert "https://" not in page


def test_a_rate_that_cannot_be(store):
    with pytest.raises(CdiaError, match="above 0"):
        fleet_trend(store, TrendSettings(false_alarms=0.0))


def without_temperature(*days: int):
    return lambda row, day: row | {"temperature": None} if day in days else row


def test_a_log_without_temperature_is_left_out_and_the_others_keep_their_regressor(trend, tmp_path):
    found = fleet_trend(stored(tmp_path, without_temperature(10)))
    (change,), (whole,) = found.changes, trend.changes
    assert change.alarm.size == pytest.approx(whole.alarm.size, rel=0.03)
    assert change.alarm.half_width == pytest.approx(whole.alarm.half_width, rel=0.1)
    left = [
        why for r in found.robots for t in r.trends for why in t.course.not_comparable if "temperature" in why
    ]
    assert left == ["it lacks the temperature that most logs have"] * (3 * len(JOINTS))
    answer = dict(trend_answer(found))
    assert "no temperature: 6" in answer["not compared"]
    assert answer["temperature"].startswith("taken out: it moves friction by 2")
    bare = fleet_trend(stored(tmp_path / "bare", without_temperature(10)), TrendSettings(regressors=False))
    assert not any("temperature" in why for t in bare.robots[0].trends for why in t.course.not_comparable)


@pytest.mark.parametrize(
    ("lacking", "said"),
    [(range(0, DAYS, 2), "not taken out: half of the logs or more lack it"), (range(DAYS), "in no log")],
)
def test_where_most_logs_lack_the_temperature_it_is_not_used(tmp_path, lacking, said):
    found = fleet_trend(stored(tmp_path, without_temperature(*lacking)))
    names = {g.name for r in found.robots for t in r.trends for g in t.regressors}
    assert names == {"load"}
    assert not any("temperature" in why for t in found.robots[0].trends for why in t.course.not_comparable)
    assert dict(trend_answer(found))["temperature"].startswith(said)


def test_a_temperature_that_does_not_vary_is_said_to_be_so(tmp_path):
    found = fleet_trend(stored(tmp_path, lambda row, day: row | {"temperature": 25.0}))
    assert dict(trend_answer(found))["temperature"].startswith("not taken out: it hardly varies")


def test_what_would_be_noticed_leaves_out_friction_that_hardly_is_there(trend, tmp_path):
    def nothing_on_the_wrist(row, day):
        if row["joints"] != "wrist":
            return row
        ends = {key: row[key] - 5.0 for key in row if key.startswith("ci95")}
        return row | ends | {"value": row["value"] - 5.0, "temperature": 25.0 + day}

    found = fleet_trend(stored(tmp_path, nothing_on_the_wrist))
    assert dict(trend_answer(trend))["would be noticed"].endswith("%)")
    assert "6 parameters" in dict(trend_answer(trend))["would be noticed"]
    assert "3 parameters" in dict(trend_answer(found))["would be noticed"]


def test_rows_of_two_versions_share_no_course(tmp_path):
    def updated(row, day):
        made = {"version": "9.9", "added": FIRST + timedelta(days=1)} if day >= CHANGE else {"version": "0.0"}
        return row | made | ({"value": row["value"] + 2.0} if day >= CHANGE else {})

    found = fleet_trend(stored(tmp_path, updated))
    assert found.changes == ()
    assert {(r.courses.logs, r.courses.outdated) for r in found.robots} == {(DAYS - CHANGE, CHANGE)}
    assert f"{3 * CHANGE} logs of another setup or version" in dict(trend_answer(found))["not compared"]


def test_logs_of_one_name_have_each_their_place(tmp_path, trend):
    found = fleet_trend(stored(tmp_path, lambda row, day: row | {"log": "run.csv"}))
    (change,), (named,) = found.changes, trend.changes
    assert change.alarm.since_time == named.alarm.since_time
    assert change.alarm.since.startswith("run.csv (")
    assert len(set(found.robots[0].trends[0].course.logs)) == DAYS
