"""``cdia demo`` on the log that ships."""

import json
import re

import numpy as np
import pytest

from cdia_pin.resources import logs_dir


@pytest.fixture(scope="module")
def told(cdia, tmp_path_factory):
    from cdia_pin.cli.demo import LOG

    assert (logs_dir() / LOG).is_file()
    out = tmp_path_factory.mktemp("demo")
    return cdia("demo", "--out", out / "new", "--json", out / "demo.json"), out


def test_the_demo_finds_what_is_hidden(told):
    outcome, out = told
    assert outcome.code == 0, outcome.err
    found = json.loads((out / "demo.json").read_text())
    assert found["verdict"] == "explained"
    assert {e["effect"] for e in found["effects"]} == {"coulomb_friction", "payload"}


def test_the_error_falls_to_the_noise(told):
    _, out = told
    found = json.loads((out / "demo.json").read_text())
    for joint, floor in found["noise_floor"].items():
        assert found["trace"][-1]["heldout_rms"][joint] < 1.5 * floor


def test_the_demo_names_commands_and_files(told):
    outcome, out = told
    for command in ("check", "compare", "discover"):
        assert f"$ cdia {command} " in outcome.out
    for name in ("demo_model.json", "demo_report.html"):
        assert (out / "new" / name).is_file()
        assert name in outcome.out
    *lines, last = outcome.out.strip().splitlines()
    assert any(line.startswith(f"Open {out / 'new' / 'demo_report.html'}") for line in lines)
    assert last == "next: cdia check LOG --robot R"


def test_the_report_of_the_demo_shows_the_arm_clearing(told):
    _, out = told
    page = (out / "new" / "demo_report.html").read_text()
    scene = json.loads(re.search(r'id="scene">(.*?)</script>', page, re.DOTALL)[1])
    levels = [max(step["level"]) for step in scene["steps"]]
    assert scene["steps"][0]["name"] == "as given"
    assert levels[0] == 1.0
    assert levels[-1] < 0.2
    assert np.ptp(scene["timeline"]["position"], axis=0).max() > 0.5


def test_a_missing_log_is_said(cdia, monkeypatch, tmp_path):
    monkeypatch.setattr("cdia_pin.cli.demo.LOG", "not_there.csv")
    assert "not_there.csv" in cdia("demo", "--out", tmp_path).error
    assert not list(tmp_path.iterdir())


def test_a_directory_that_cannot_be_made_is_said(cdia, tmp_path):
    (tmp_path / "file").write_text("")
    assert "cannot make the directory" in cdia("demo", "--out", tmp_path / "file" / "out").error
