"""``cdia campaign`` and ``cdia tune``: the short answer first, then the runs that went wrong and their commands."""

import json

import pytest

from cdia_pin.campaigns import read_spec

PLAN = """
robots = "double_pendulum"
rate = 250.0
healthy_runs = 1
healthy_duration = 8.0
duration = 6.0
bank = ["coulomb_friction", "viscous_friction"]
{more}
[[faults]]
terms = "viscous_friction@joint2: coefficient=1, after=3"
share = {share}
"""


@pytest.fixture(scope="module")
def ran(cdia, tmp_path_factory):
    folder = tmp_path_factory.mktemp("campaign")
    plan = folder / "plan.toml"
    plan.write_text(PLAN.format(more="repeats = 1\nhealthy = 3.0", share="[0.0001, 0.3]"), encoding="utf-8")
    command = ("campaign", plan, "--out", folder / "runs", "--workers", 1)
    return cdia(*command, "--json", folder / "c.json", "--report", folder / "c.html"), folder


def test_the_answer_comes_first_and_a_run_that_went_wrong_can_be_repeated(cdia, ran):
    outcome, folder = ran
    assert outcome.code == 0, outcome.err
    answer = " ".join(outcome.out.split())
    assert answer.startswith("50 % [1, 99] of 2 faults detected")
    assert "not detected" in outcome.out
    assert json.loads((folder / "c.json").read_text())["schema"] == "cdia-campaign/1"
    page = (folder / "c.html").read_text()
    assert f"cdia campaign {folder / 'runs'} --replay 1" in page
    assert "http" not in page.replace("http-equiv", "")
    *_, last = outcome.out.splitlines()
    words = last.removeprefix("next: cdia ").split()
    again = cdia(*words)
    assert again.code == 0, again.err
    assert "run 1: double_pendulum" in again.out


def test_a_folder_shows_its_result_again(cdia, ran):
    folder = ran[1]
    shown = cdia("campaign", folder / "runs", "--json", "-").json
    assert shown == json.loads((folder / "c.json").read_text())


def test_what_cannot_be_is_said_in_one_line(cdia, ran):
    plan, runs = ran[1] / "plan.toml", ran[1] / "runs"
    assert "go with a plan" in cdia("campaign", runs, "--workers", 2).error
    assert "--replay takes the folder" in cdia("campaign", plan, "--replay", 1).error
    assert "this campaign has runs 0 to 2, given 9" in cdia("campaign", runs, "--replay", 9).error
    assert (
        "'--workers': must be 1 to 4096"
        in cdia("campaign", plan, "--out", ran[1] / "new", "--workers", 0).error
    )
    assert "'--false-alarms': must be 1e-09" in cdia("tune", plan, "--false-alarms", 0).error


def test_tuning_keeps_its_rate_and_says_how_to_confirm_it(cdia, tmp_path):
    plan = tmp_path / "plan.toml"
    more = "repeats = 2\nhealthy = 210.0\n[settings]\nbandwidth = [30.0]\ndebounce = [1, 4]"
    slow = PLAN.replace("250.0", "100.0")
    plan.write_text(slow.format(more=more, share="0.2"), encoding="utf-8")
    outcome = cdia(
        "tune",
        plan,
        "--false-alarms",
        2,
        "--out",
        tmp_path / "t",
        "--workers",
        1,
        "--json",
        tmp_path / "t.json",
    )
    assert outcome.code == 0, outcome.err
    found = json.loads((tmp_path / "t.json").read_text())
    assert found["schema"] == "cdia-tuning/1"
    assert found["settings"]["false_alarm_every"] == 3600.0
    factors = {o["settings"]["debounce"]: o["factor"] for o in found["options"]}
    assert factors[4] < factors[1]  # what must last longer may be smaller
    rates = [o["factor"] for o in found["rates"]]
    assert rates == sorted(rates, reverse=True)  # rarer alarms need higher thresholds
    confirm = read_spec(tmp_path / "t" / "confirm.toml")
    assert confirm.seed == read_spec(plan).seed + 1
    assert dict(confirm.settings)["debounce"] == (found["settings"]["debounce"],)
