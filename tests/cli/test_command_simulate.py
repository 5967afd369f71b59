"""``cdia simulate`` makes a log that the other commands read."""

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


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--fault", "columb_friction@joint1: level=1"], "did you mean coulomb_friction"),
        (["--fault", "coulomb_friction@jiont1: level=1"], "did you mean joint1"),
        (["--fault", "coulomb_friction@joint1: lvl=1"], "level"),
        (["--fault", "coulomb_friction@joint1: level=much"], "much"),
        (["--duration", "-1"], "duration"),
        (["--rate", "0"], "rate"),
        (["--noise", "-1"], "0 or more"),
        (["--seed", "-1"], "seed"),
        (["--out", "run.xlsx"], ".parquet"),
    ],
)
def test_bad_settings_are_one_line(cdia, tmp_path, arguments, said):
    out = [] if "--out" in arguments else ["--out", tmp_path / "run.csv"]
    assert said in cdia("simulate", *ROBOT, *arguments, *out).error
    assert not list(tmp_path.iterdir())
