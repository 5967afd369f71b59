"""The page: one file, small, silent on the network, and no name can become markup."""

import json
import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from cdia_pin.discovery import compare
from cdia_pin.errors import CdiaError
from cdia_pin.viewers import verdict_sentences, write_report
from cdia_pin.viewers.page import LARGEST, embeddable
from cdia_pin.viewers.report_data import report_data

DATA = re.compile(r'<script type="application/json" id="data">(.*?)</script>', re.DOTALL)


@pytest.fixture(scope="module")
def page(results, tmp_path_factory):
    return results.write(tmp_path_factory.mktemp("report") / "new" / "folder" / "report.html")


def data_of(page):
    (text,) = DATA.findall(page)
    return json.loads(text)


def test_it_is_one_small_file(page):
    assert page.startswith("<!doctype html>")
    assert len(page.encode()) < LARGEST


def test_a_long_log_still_fits(results, tmp_path):
    given, many = results.given, 80
    tall = lambda x: np.tile(x, (many, 1))  # noqa: E731
    long = replace(
        given,
        time=np.arange(many * len(given.time)) * (given.time[1] - given.time[0]),
        measured=tall(given.measured),
        predicted=tall(given.predicted),
        informative=tall(given.informative),
        signals={k: tall(v) for k, v in given.signals.items()},
    )
    assert len(long.time) > 20_000
    path = write_report(tmp_path / "long.html", long, improved=long, discovery=results.discovery)
    assert path.stat().st_size <= LARGEST


def test_nothing_is_requested_from_anywhere(page):
    links = re.findall(r"""\b(?:src|href|action|data|poster|srcset)\s*=\s*["']([^"']*)""", page)
    assert set(links) == {"data:,"}
    assert "@import" not in page
    assert not re.search(r"url\(\s*['\"]?https?:", page)
    assert "default-src 'none'" in page


def test_the_same_results_give_the_same_bytes(results, page, tmp_path):
    assert results.write(tmp_path / "again.html") == page


def test_data_in_the_page_is_what_was_collected(results, page):
    collected = report_data(
        results.given,
        results.improved,
        results.discovery,
        results.checks,
        command=data_of(page)["command"],
    )
    assert data_of(page) == json.loads(json.dumps(collected))


def test_every_joint_is_there_with_its_units(results, page):
    joints = data_of(page)["joints"]
    assert tuple(j["name"] for j in joints) == results.robot.joints
    assert [j["units"]["load"] for j in joints] == ["N·m", "N·m", "N·m", "N"]
    assert [j["units"]["velocity"] for j in joints] == ["rad/s", "rad/s", "rad/s", "m/s"]


def test_head_names_logs_and_command(page):
    data = data_of(page)
    assert [log["source"] for log in data["logs"]] == ["a.csv", "second a.csv"]
    assert [log["source"] for log in data["holdout"]] == ["held out a.csv"]
    assert data["command"].startswith("cdia discover")


def test_the_verdict_is_readable_without_javascript(results, page):
    (fallback,) = re.findall(r"<noscript>(.*?)</noscript>", page, re.DOTALL)
    assert verdict_sentences(results.discovery)[0] in fallback


def test_effects_carry_numbers_with_units_and_doubts(results, doubtful):
    (effect,) = report_data(results.given, results.improved, doubtful)["discovery"]["effects"]
    assert effect["name"] == "stribeck friction"
    assert effect["parameters"][0]["text"].replace("\xa0", " ") == "4.00 ± 0.10 N·m"
    assert [p["telling"] for p in effect["parameters"]] == [True, False]
    assert effect["shape"][0]["text"].replace("\xa0", " ") == "8.00 s/rad"
    assert effect["confusions"] == [
        {"words": "coulomb friction on joint3", "motion": "to distinguish them, move the joint slowly"}
    ]


def test_a_comparison_alone_makes_a_page(results, tmp_path):
    data = data_of(write_report(tmp_path / "compare.html", results.given).read_text(encoding="utf-8"))
    assert data["discovery"] is None
    assert data["regions"]["after"] is None
    assert all(j["after"] is None for j in data["joints"])


def test_the_arm_is_in_the_page_and_clears_step_by_step(results, page):
    (text,) = re.findall(r'<script type="application/json" id="scene">(.*?)</script>', page, re.DOTALL)
    scene = json.loads(text)
    assert tuple(j["name"] for j in scene["arm"]["joints"]) == results.robot.joints
    names = [s["name"] for s in scene["steps"]]
    assert names[0] == "as given"
    assert len(names) == len(results.discovery.trace)
    worst = int(np.argmax(scene["steps"][0]["level"]))
    levels = [s["level"][worst] for s in scene["steps"]]
    assert levels[0] == 1.0
    assert levels[-1] < 0.2
    time = np.array(scene["timeline"]["time"])
    assert (np.diff(time) > 0).all()
    assert len(scene["timeline"]["variants"]) == 1


def test_a_comparison_alone_has_no_steps(results, tmp_path):
    page = write_report(tmp_path / "compare.html", results.given).read_text(encoding="utf-8")
    (text,) = re.findall(r'<script type="application/json" id="scene">(.*?)</script>', page, re.DOTALL)
    assert json.loads(text)["steps"] == []


def test_hostile_names_stay_text(hostile, page, tmp_path):
    wicked = hostile.write(tmp_path / "hostile.html")
    assert wicked.count("</script>") == page.count("</script>")
    assert "<img" not in wicked
    assert "<script>alert" not in wicked
    assert data_of(wicked)["joints"][1]["name"] == hostile.robot.joints[1]


def test_embedded_json_survives_the_round_trip():
    wicked = {"a": "</script><!--&\u2028", "b": [1.5, None, "τ"]}
    assert not set("<>&\u2028") & set(embeddable(wicked))
    assert json.loads(embeddable(wicked)) == wicked


def test_results_of_different_logs_are_refused(results, tmp_path):
    other = compare(results.discovery.model, results.logs[0])
    with pytest.raises(CdiaError, match="same logs"):
        write_report(tmp_path / "no.html", results.given, improved=other)


def test_a_place_that_cannot_be_written_is_an_error_of_ours(results, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(CdiaError, match="cannot be written"):
        write_report(tmp_path / "file" / "report.html", results.given)


CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
QUIET = (
    "--headless --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader "
    "--disable-background-networking --disable-component-update --disable-sync --no-first-run "
    "--enable-logging=stderr --dump-dom"
)


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium to open the page with")
def test_a_browser_draws_it_without_a_complaint(hostile, tmp_path):
    hostile.write(tmp_path / "report.html")
    command = [CHROMIUM, *QUIET.split(), f"--user-data-dir={tmp_path / 'profile'}"]
    try:
        run = subprocess.run(
            [*command, (tmp_path / "report.html").as_uri()], capture_output=True, timeout=30, check=False
        )
    except subprocess.TimeoutExpired:
        pytest.skip("Chromium did not answer within 30 s")
    page, said = run.stdout.decode(), run.stderr.decode(errors="replace")
    assert "CONSOLE" not in said, said
    assert page.count("<canvas") >= 6  # torque, residual, and four against motion
    assert "<img" not in page
    for heading in ("The arm in motion", "What the model lacks", "Error by joint", "Worst regions"):
        assert heading in page
