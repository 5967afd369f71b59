"""``cdia study``: numbers on the terminal, in JSON, and as figures."""

import json
from dataclasses import replace
from functools import partial

import pytest

from cdia_pin.campaigns import arm_study, thesis_study
from cdia_pin.campaigns.closed_loop import LoopSettings
from cdia_pin.campaigns.thesis_presets import PRESETS, physical


def test_the_model_of_the_scara_arm(cdia):
    shown = cdia("study", "scara-model")
    assert shown.code == 0, shown.err
    assert "power balance" in shown.out
    assert "6.0e-03" in shown.out
    assert "agrees with the URDF" in shown.out


def test_its_json(cdia):
    found = cdia("study", "scara-model", "--json", "-").json
    assert found["schema"] == "cdia-study-scara-model/1"
    assert found["agrees"] is True
    assert {t["term"] for t in found["terms"][:3]} == {"M", "V", "G"}
    assert max(t["corrected"] for t in found["terms"][:3]) <= 1e-11


def test_the_thesis_study_writes_figures_report_and_numbers(cdia, tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.setattr("cdia_pin.viewers.study_figures.DPI", 30)

    def short(scenario):
        faults = tuple(replace(f, start=0.2) for f in scenario.faults)
        return replace(scenario, faults=faults, duration=2.4, tick=2e-3)

    def one_short_case(robot):
        whole = physical(robot)
        return replace(whole, cases={"loss": short(whole.cases["30 % torque loss"])})

    scenario = thesis_study._scenario
    monkeypatch.setitem(PRESETS, "physical", one_short_case)
    monkeypatch.setattr(thesis_study, "_mixtures", lambda: iter(()))
    monkeypatch.setattr(thesis_study, "_scenario", lambda true: short(scenario(true)))
    out, numbers = tmp_path / "figures", tmp_path / "study.json"
    shown = cdia("study", "thesis", "--preset", "physical", "--out", out, "--json", numbers)
    assert shown.code == 0, shown.err
    assert "preset physical" in shown.out
    assert len(list(out.glob("*.png"))) == 6
    assert "data:image/png" in (out / "thesis_study.html").read_text(encoding="utf-8")
    document = json.loads(numbers.read_text(encoding="utf-8"))
    assert document["schema"] == "cdia-study-thesis/1"
    case = document["presets"]["physical"]["cases"][0]
    assert case["tracking_rms"]["accommodated"]["joint1"] < 0.2 * case["tracking_rms"]["faulty"]["joint1"]
    assert document["record"]["version"]


def test_the_study_of_arms_writes_figures_report_and_numbers(cdia, tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.setattr("cdia_pin.viewers.study_figures.DPI", 30)
    settings = LoopSettings(rate=250.0, healthy_runs=1, healthy_duration=8.0)
    study = partial(
        arm_study.arm_study, ["double_pendulum"], settings=settings, duration=7.0, cases=["30 % torque loss"]
    )
    monkeypatch.setattr(arm_study, "arm_study", study)
    numbers = tmp_path / "arms.json"
    shown = cdia("study", "arms", "--out", tmp_path / "figures", "--json", numbers)
    assert shown.code == 0, shown.err
    assert "double_pendulum" in shown.out
    assert sorted(p.suffix for p in (tmp_path / "figures").iterdir()) == [".html", ".png"]
    document = json.loads(numbers.read_text(encoding="utf-8"))
    assert document["schema"] == "cdia-study-arms/1"
    assert document["record"]["loop"]["rate"] == 250.0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["tesis"], "did you mean thesis"),
        (["thesis", "--preset", "litteral"], "did you mean literal"),
        (["arms", "--preset", "literal"], "takes no --preset"),
        (["scara-model", "--preset", "literal"], "takes neither --preset nor --out"),
        (["scara-model", "--json", "/nowhere/x.json"], "no directory /nowhere"),
        ([], "NAME"),
    ],
)
def test_a_wrong_request_is_one_line(cdia, arguments, said):
    assert said.lower() in cdia("study", *arguments).error.lower()


def test_a_directory_that_cannot_be_made_is_one_line(cdia, tmp_path):
    file = tmp_path / "taken"
    file.write_text("")
    assert "cannot make the directory" in cdia("study", "thesis", "--out", file).error
