"""``cdia identify``: options, tables and files."""

import json

import pytest

from cdia_pin import load_model, load_robot


@pytest.fixture(scope="module")
def outcome(cdia, logs, tmp_path_factory):
    """One run of the command, and the folder that it wrote to."""
    folder = tmp_path_factory.mktemp("identified")
    done = cdia(
        "identify", logs / "run.csv", "--robot", "double_pendulum", "--holdout", logs / "other.csv",
        "--save", folder / "model.json", "--urdf", folder / "corrected.urdf", "--json", folder / "found.json",
    )  # fmt: skip
    assert done.code == 0, done.err
    return done, folder


def test_it_shows_errors_friction_and_base_parameters(outcome):
    said = outcome[0].out
    for words in (
        "torque RMS",
        "held out",
        "coulomb friction",
        "rotor inertia",
        "base parameter",
        "identifiable",
    ):
        assert words in said
    assert "Every link is physically consistent." in said
    assert "other.csv" in said


def test_it_finds_the_friction_that_was_hidden(outcome):
    found = json.loads((outcome[1] / "found.json").read_text())
    (friction,) = (
        t["parameters"]["level"]
        for t in found["terms"]
        if (t["effect"], t["joints"]) == ("coulomb_friction", ["joint2"])
    )
    lower, upper = friction["ci95"]
    assert lower <= 0.05 <= upper
    held_out = found["heldout_rms"]
    assert held_out["after"]["joint2"] < 0.6 * held_out["before"]["joint2"]


def test_it_writes_a_model_and_a_urdf_that_load_again(outcome):
    folder = outcome[1]
    robot = load_robot("double_pendulum")
    model = load_model(folder / "model.json", robot)
    assert {t.effect.name for t in model.terms} >= {"link_inertia", "coulomb_friction", "rotor_inertia"}
    corrected = load_robot(folder / "corrected.urdf")
    totals = json.loads((folder / "found.json").read_text())["inertial_parameters"]
    for j, joint in enumerate(robot.joints):
        assert corrected.inertial_parameters[j] == pytest.approx(totals[joint], abs=1e-6)


def test_json_on_stdout_silences_the_tables(cdia, log):
    done = cdia("identify", log, "--robot", "double_pendulum", "--plain", "--json", "-")
    assert done.json["schema"] == "cdia-identification/1"
    assert done.json["refined"] == []
    assert done.json["record"]["holdout"] == []


def test_all_shows_every_base_parameter(cdia, log):
    done = cdia("identify", log, "--robot", "double_pendulum", "--plain", "--all")
    assert "furthest from the URDF" not in done.out
    assert "  no" in done.out  # what the motion does not tell is listed too


def test_a_log_cannot_be_fitted_and_held_out(cdia, log):
    assert "fitted" in cdia("identify", log, "--robot", "double_pendulum", "--holdout", log).error


def test_an_input_is_not_overwritten(cdia, log):
    assert "overwritten" in cdia("identify", log, "--robot", "double_pendulum", "--save", log).error


def test_help_has_an_example(cdia):
    done = cdia("identify", "--help")
    assert done.code == 0
    assert "cdia identify run.csv" in done.out
