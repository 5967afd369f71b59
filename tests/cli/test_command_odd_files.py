"""Odd files that were once a fault of the program, or said something misleading."""

import json

import pytest

from cdia_pin import write_log
from tests.cli.conftest import pendulum_log

ROBOT = ["--robot", "double_pendulum"]


@pytest.mark.parametrize(
    "arguments",
    [
        ["check", "loop.csv"],
        ["compare", "run.csv", "loop.csv"],
        ["discover", "run.csv", "--holdout", "loop.csv"],
        ["calibrate", "loop.csv", "run.csv", "--known-payload", "1"],
        ["convert", "run.csv", "loop.csv"],
        ["compare", "run.csv", "--model", "loop.csv"],
        ["identify", "run.csv", "--save", "loop.csv"],
    ],
)
def test_a_link_to_itself_is_refused(cdia, log, tmp_path, monkeypatch, arguments):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "loop.csv").symlink_to("loop.csv")
    (tmp_path / "run.csv").write_bytes(log.read_bytes())
    assert "loop.csv" in cdia(*arguments, *ROBOT).error


@pytest.mark.parametrize("signal", ["position", "effort"])
@pytest.mark.parametrize("healthy", [True, False])
def test_a_monitor_does_not_learn_from_numbers_beyond_all_units(cdia, log, tmp_path, signal, healthy):
    run = pendulum_log(1)
    getattr(run, signal)[:, 0] *= 1e200
    huge = write_log(run, tmp_path / "huge.csv")
    given = [log, "--healthy", huge] if healthy else [huge]
    said = cdia("monitor", *given, *ROBOT, "--no-check").error
    assert f"the {signal} of joint1 reaches" in said and "no arm in any unit" in said
    assert "samples, first in sample " in said


def test_a_text_that_is_called_npz_brings_no_advice_to_load_it_unsafely(cdia, log, tmp_path):
    fake = tmp_path / "fake.npz"
    fake.write_bytes(log.read_bytes())
    assert cdia("check", fake, *ROBOT).error.endswith("not readable as .npz (it is no zip archive)")


def test_efforts_of_no_unit_are_said_in_a_short_line(cdia, tmp_path):
    run = pendulum_log(1)
    run.effort[:] *= 1e-300
    file = write_log(run, tmp_path / "tiny.csv")
    found = json.loads(cdia("check", file, *ROBOT, "--json", "-").out)["findings"]
    (said,) = [f["message"] for f in found if f["topic"] == "effort_kind"]
    assert "any ratio" in said and len(said) < 300


def test_a_folder_without_a_campaign_is_said_in_plain_words(cdia, tmp_path):
    said = cdia("campaign", tmp_path).error
    assert said.endswith("holds no campaign: campaign.json: No such file or directory")
