"""``cdia simulate`` makes a log that the other commands read."""

import json

import numpy as np
import pytest

from cdia_pin import load_robot, read_log

ROBOT = ("--robot", "double_pendulum")


@pytest.fixture(scope="module")
def simulated(cdia, tmp_path_factory):
    out = tmp_path_factory.mktemp("simulated") / "run.csv"
    fault = "coulomb_friction@joint2: level=0.03"
    return cdia("simulate", *ROBOT, "--fault", fault, "--duration", "10", "--out", out, "--json", "-"), out


def test_its_json_is_as_the_contract_says(simulated):
    found = simulated[0].json
    assert found["schema"] == "cdia-events/1"
    assert found["events"] == []
    assert list(found["tracking_rms"]) == ["joint1", "joint2"]


def test_the_fault_is_in_the_log(cdia, simulated):
    assert cdia("check", simulated[1], *ROBOT).code == 0
    errors = cdia("compare", simulated[1], *ROBOT, "--json", "-").json["rms"]
    assert errors["joint2"] == pytest.approx(0.03, rel=0.3)


def test_a_seed_makes_it_repeatable(cdia, tmp_path):
    runs = {}
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        out = tmp_path / f"{name}.npz"
        shown = cdia("simulate", *ROBOT, "--duration", "3", "--seed", seed, "--out", out)
        assert shown.code == 0, shown.err
        assert "tracking error" in shown.out
        runs[name] = read_log(out, load_robot("double_pendulum")).effort
    assert np.array_equal(runs["a"], runs["b"])
    assert not np.array_equal(runs["a"], runs["c"])


LOOP = ("--fault", "viscous_friction@joint2: coefficient=0.2, after=3", "--duration", "7", "--rate", "250",
        "--bank", "coulomb_friction", "--bank", "viscous_friction")  # fmt: skip


@pytest.fixture(scope="module")
def loops(cdia, tmp_path_factory):
    """The same loop, corrected and only watched."""
    out = tmp_path_factory.mktemp("loops")
    found = {}
    for how in ("accommodate", "no-accommodate"):
        shown = cdia(
            "simulate", *ROBOT, *LOOP, f"--{how}", "--out", out / f"{how}.csv", "--json", out / f"{how}.json",
            "--report", out / f"{how}.html",
        )  # fmt: skip
        assert shown.code == 0, shown.err
        found[how] = shown.out, json.loads((out / f"{how}.json").read_text(encoding="utf-8"))
    return found, out


def test_accommodation_brings_tracking_back(loops):
    text, document = loops[0]["accommodate"]
    tracking = document["tracking"]
    assert tracking["since"] == 3.0
    assert tracking["faulty"]["joint2"] > 5 * tracking["healthy"]["joint2"]
    assert tracking["accommodated"]["joint2"] < 0.5 * tracking["faulty"]["joint2"]
    assert document["tracking_rms"] == tracking["accommodated"]
    assert "accommodated" in text
    assert "over healthy" in text


def test_a_monitor_that_only_watches_names_the_fault_and_changes_nothing(loops):
    text, document = loops[0]["no-accommodate"]
    assert [e["stage"] for e in document["events"]] == ["detection", "isolation"]
    assert document["faults"][0]["effect"] == "viscous_friction"
    assert "accommodated" not in document["tracking"]
    with_monitor, alone = document["tracking"]["faulty"], loops[0]["accommodate"][1]["tracking"]["faulty"]
    assert with_monitor == alone
    assert "over healthy" not in text


def test_the_log_of_a_loop_says_the_same_to_the_command_monitor(cdia, loops):
    log = loops[1] / "no-accommodate.csv"
    bank = ("--bank", "coulomb_friction", "--bank", "viscous_friction")
    watched = cdia("monitor", log, *ROBOT, *bank, "--no-check", "--healthy-until", "2.9", "--json", "-").json
    (fault,) = watched["faults"]
    assert (fault["effect"], fault["joint"]) == ("viscous_friction", "joint2")
    assert fault["parameters"]["coefficient"]["value"] == pytest.approx(0.2, rel=0.05)


def test_the_report_of_a_loop_has_its_tracking(loops):
    page = (loops[1] / "accommodate.html").read_text(encoding="utf-8")
    assert '"runs":{"healthy":[' in page


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--bank", "coulomb_friction"], "add --accommodate"),
        (["--report", "r.html"], "add --accommodate"),
        (["--accommodate", "--engine", "tesis"], "did you mean thesis"),
        (["--accommodate", "--model-error", "2"], "'--model-error': must be 0 to 0.5, given 2"),
        (["--accommodate", "--rate", "0"], "rate"),
        (["--accommodate", "--bank", "payload"], "not an effect of one joint"),
        (["--accommodate", "--duration", "-1"], "duration"),
    ],
)
def test_bad_settings_of_a_loop_are_one_line(cdia, tmp_path, arguments, said):
    assert said in cdia("simulate", *ROBOT, *arguments, "--out", tmp_path / "run.csv").error
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--fault", "columb_friction@joint1: level=1"], "did you mean coulomb_friction"),
        (["--fault", "coulomb_friction@jiont1: level=1"], "did you mean joint1"),
        (["--fault", "coulomb_friction@joint1: lvl=1"], "level"),
        (["--fault", "coulomb_friction@joint1: level=much"], "much"),
        (["--duration", "-1"], "duration"),
        (["--rate", "0"], "rate"),
        (["--noise", "-1"], "'--noise': must be 0 to 10, given -1"),
        (["--seed", "-1"], "seed"),
        (["--out", "run.xlsx"], ".parquet"),
    ],
)
def test_bad_settings_are_one_line(cdia, tmp_path, arguments, said):
    out = [] if "--out" in arguments else ["--out", tmp_path / "run.csv"]
    assert said in cdia("simulate", *ROBOT, *arguments, *out).error
    assert not list(tmp_path.iterdir())
