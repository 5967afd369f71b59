"""``cdia compare`` and ``discover`` of several logs: what changed, and parameters per log."""

import html
import json
import re

import pytest

from cdia_pin import load_model, load_robot, write_log
from tests.cli.conftest import pendulum_log

COLD, WARM = "viscous_friction@joint1: coefficient=0.2", "viscous_friction@joint1: coefficient=0.1"


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    """Folder of logs: ``cold.csv``, and ``warm.csv`` and ``warmer.csv`` with half the friction."""
    folder = tmp_path_factory.mktemp("pair")
    for seed, name, hidden in ((1, "cold.csv", COLD), (2, "warm.csv", WARM), (3, "warmer.csv", WARM)):
        write_log(pendulum_log(seed, hidden), folder / name)
    return folder


def test_what_changed_is_reported_with_its_size(cdia, pair):
    done = cdia("compare", pair / "cold.csv", pair / "warm.csv", "--robot", "double_pendulum", "--no-check")
    assert done.code == 0, done.err
    assert "From cold.csv to warm.csv: viscous friction on joint1" in " ".join(done.out.split())
    assert "(−50" in done.out


def test_json_has_the_errors_by_log_and_the_changes(cdia, pair):
    logs = [pair / n for n in ("cold.csv", "warm.csv")]
    document = cdia("compare", *logs, "--robot", "double_pendulum", "--no-check", "--json", "-").json
    assert [one["record"]["logs"][0]["source"] for one in document["by_log"]] == ["cold.csv", "warm.csv"]
    (changes,) = document["changes"]
    assert changes["verdict"] == "changed"
    (change,) = changes["changes"]
    assert (change["effect"], change["joints"]) == ("viscous_friction", ["joint1"])
    coefficient = change["difference"]["coefficient"]
    low, high = coefficient["ci95"]
    assert coefficient["value"] == pytest.approx(-0.1, rel=0.02)
    assert low < coefficient["value"] < high < 0
    assert change["growth"] == pytest.approx(-0.5, abs=0.05)


def test_the_report_says_what_changed_and_the_error_in_each_log(cdia, pair, tmp_path):
    logs, page = [pair / n for n in ("cold.csv", "warm.csv")], tmp_path / "report.html"
    done = cdia("compare", *logs, "--robot", "double_pendulum", "--no-check", "--report", page)
    assert done.code == 0, done.err
    text = page.read_text(encoding="utf-8")
    data = json.loads(
        re.findall(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)[0]
    )
    (changes,) = data["changes"]
    assert changes["sentence"].startswith("From cold.csv to warm.csv: viscous friction on joint1")
    assert changes["sentence"] in html.unescape(*re.findall(r"<noscript>(.*?)</noscript>", text, re.DOTALL))
    (change,) = changes["changes"]
    assert (change["name"], change["where"], change["confidence"]) == (
        "viscous friction",
        "joint1",
        "established",
    )
    assert change["growth"].startswith("−50")
    assert [log["name"] for log in data["by_log"]] == ["cold.csv", "warm.csv"]


def test_logs_of_one_name_are_told_apart(cdia, pair, tmp_path):
    again = tmp_path / "cold.csv"
    again.write_bytes((pair / "warm.csv").read_bytes())
    done = cdia("compare", pair / "cold.csv", again, "--robot", "double_pendulum", "--no-check")
    said = " ".join(done.out.split())
    assert "From cold.csv to cold.csv (2): viscous friction" in said
    assert said.count("cold.csv (2)") == 2  # in the table of errors too


def test_one_log_is_compared_with_the_model_alone(cdia, pair):
    document = cdia(
        "compare", pair / "cold.csv", "--robot", "double_pendulum", "--no-check", "--json", "-"
    ).json
    assert "changes" not in document


def test_nothing_changed_is_a_claim_with_a_bound(cdia, pair):
    logs = [pair / n for n in ("warm.csv", "warmer.csv")]
    done = cdia("compare", *logs, "--robot", "double_pendulum", "--no-check")
    assert "These logs show no change from warm.csv to warmer.csv" in " ".join(done.out.split())
    assert "would not show (RMS): joint1" in " ".join(done.out.split())


def test_logs_of_one_condition_are_compared_together(cdia, pair):
    logs = [pair / n for n in ("cold.csv", "warm.csv", "warmer.csv")]
    condition = f"warm={logs[1]},{logs[2]}"
    document = cdia(
        *(
            "compare",
            *logs,
            "--robot",
            "double_pendulum",
            "--no-check",
            "--condition",
            condition,
            "--json",
            "-",
        )
    ).json
    (changes,) = document["changes"]
    assert (changes["before"], changes["after"]) == (["cold.csv"], ["warm", "warm"])


def test_a_discovery_gives_each_log_its_own_friction(cdia, pair, tmp_path):
    logs, saved = [pair / n for n in ("cold.csv", "warm.csv")], tmp_path / "model.json"
    done = cdia("discover", *logs, "--robot", "double_pendulum", "--no-check", "--save", saved)
    assert done.code == 0, done.err
    robot = load_robot("double_pendulum")
    (term,) = load_model(saved, robot).terms
    assert term.label == "viscous_friction@joint1[log]"
    assert term.values["coefficient[cold.csv]"] == pytest.approx(0.2, rel=0.05)
    assert term.values["coefficient[warm.csv]"] == pytest.approx(0.1, rel=0.05)
    assert "viscous friction per log" in done.out
    again = cdia(
        "compare", logs[0], "--robot", "double_pendulum", "--model", saved, "--no-check", "--json", "-"
    )
    assert max(again.json["relative_rms"].values()) < 0.02


def test_parameters_per_log_can_be_asked_for(cdia, pair):
    logs = [pair / n for n in ("warm.csv", "warmer.csv")]
    document = cdia(
        *("add", "viscous_friction@joint1", *logs, "--robot", "double_pendulum", "--no-check"),
        *("--per-log", "viscous_friction", "--json", "-"),
    ).json
    (effect,) = document["effects"]
    assert effect["varies"] == {"with": "log", "logs": ["warm.csv", "warmer.csv"]}
    assert set(effect["parameters"]) == {"coefficient[warm.csv]", "coefficient[warmer.csv]"}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--per-log", "no_such_effect"], "no_such_effect"),
        (["--per-log", "encoder_offset"], "one value"),
        (["--per-log", "coulomb_friction@no_joint"], "no_joint"),
        (["--condition", "warm"], "NAME=LOG"),
        (["--condition", "warm=other.csv"], "not among the logs"),
    ],
)
def test_bad_conditions_are_one_line(cdia, pair, options, said):
    logs = [pair / n for n in ("cold.csv", "warm.csv")]
    assert said in cdia("discover", *logs, "--robot", "double_pendulum", *options).error


def test_parameters_per_log_need_two_conditions(cdia, pair):
    logs = [pair / n for n in ("warm.csv", "warmer.csv")]
    condition = f"warm={logs[0]},{logs[1]}"
    options = ["--per-log", "coulomb_friction", "--condition", condition]
    assert "two conditions" in cdia("discover", *logs, "--robot", "double_pendulum", *options).error


def test_a_log_has_one_condition(cdia, pair):
    log, other = pair / "cold.csv", pair / "warm.csv"
    options = ["--condition", f"a={log}", "--condition", f"b={log}"]
    assert "two conditions" in cdia("compare", log, other, "--robot", "double_pendulum", *options).error


@pytest.fixture(scope="module")
def behind_the_gear(cdia, pair):
    """A model of the first log, whose torque is said to be from behind the gear."""
    model = pair / "behind.json"
    given = (pair / "cold.csv", "--robot", "double_pendulum", "--no-check")
    done = cdia("discover", *given, "--torque-side", "link", "--save", model)
    assert done.code == 0, done.err
    return model


SIDE = "the torque is taken as measured behind the gear"


@pytest.mark.parametrize("command", ["compare", "discover", "identify", "monitor"])
def test_later_logs_are_of_the_side_of_the_gear_that_the_model_was_learned_on(
    cdia, pair, behind_the_gear, command
):
    logs = [pair / "warm.csv", *([pair / "cold.csv"] if command == "compare" else [])]
    given = (command, *logs, "--robot", "double_pendulum", "--no-check")
    done = cdia(*given, "--model", behind_the_gear)
    assert done.code == 0, done.err
    said = " ".join(done.out.split())
    assert SIDE in said
    assert not any(name in said for name in ("coulomb friction", "viscous friction", "rotor inertia"))
    assert SIDE not in " ".join(cdia(*given).out.split())


def test_a_side_that_is_said_comes_before_that_of_the_model(cdia, pair, behind_the_gear):
    logs = (pair / "cold.csv", pair / "warm.csv")
    asked = ("--robot", "double_pendulum", "--no-check", "--model", behind_the_gear)
    done = cdia("compare", *logs, *asked, "--torque-side", "motor")
    assert SIDE not in " ".join(done.out.split())
    assert "viscous friction on joint1" in " ".join(done.out.split())
