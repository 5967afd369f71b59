"""Every command works with an arm of one joint."""

import json

import numpy as np
import pytest
import typer

from cdia_pin import Dynamics, Log, load_robot, read_log, write_log
from cdia_pin.app.inputs import Request
from cdia_pin.app.picture import joint, timeline
from cdia_pin.app.session import Session
from cdia_pin.cli.program import app
from cdia_pin.discovery.addition import add_effect_in
from cdia_pin.effects import parse_effect, parse_term
from cdia_pin.selection import DiscoverySettings
from cdia_pin.selection.problem import Problem
from cdia_pin.viewers.live import LiveView
from tests import one_joint
from tests.cli.conftest import motion

FRICTION = "coulomb_friction@only: level="
LOGS = {"clean.csv": (), "run.csv": (f"{FRICTION}0.5",), "grown.csv": (f"{FRICTION}0.9",)}
COMMANDS = {
    "robots": "robots {urdf}",
    "check": "check {run} --robot {urdf}",
    "compare": "compare {clean} {run} --robot {urdf}",
    "discover": "discover {run} --robot {urdf} --holdout {grown} --all",
    "add": "add payload {run} --robot {urdf} --model {model}",
    "excite": "excite --between payload viscous_friction@only --duration 6 --robot {urdf} --out {out}.csv",
    "monitor": "monitor {grown} --healthy {run} --robot {urdf}",
    "identify": "identify {run} --robot {urdf}",
    "export": "export --model {model} --urdf {out}.urdf --robot {urdf}",
    "simulate": "simulate --fault payload:mass=0.5,after=1 --duration 2 --robot {urdf} --out {out}.csv",
    "convert": "convert {run} {out}.npz --robot {urdf}",
    "view": "view {run} --robot {urdf} --no-open",
    "fleet": "fleet add --robots {map} --store {out}-store",
}
WITHOUT_A_ROBOT = {"demo", "effects", "study", "trend"}  # the robot of a trend is that of its store
MANY_RUNS = {"campaign", "tune"}  # which take longer than a test should
NEEDS_MORE_JOINTS = {"calibrate"}  # a known weight at the tool of an arm that moves it against gravity


@pytest.fixture(scope="module", params=["revolute", "prismatic"])
def given(request, tmp_path_factory):
    """Paths of the arm, its logs and a model of it."""
    folder = tmp_path_factory.mktemp(request.param)
    robot = load_robot(one_joint.write_urdf(request.param, folder))
    for seed, (name, hidden) in enumerate(LOGS.items()):
        t, q, v, a = motion(1, seed, duration=10.0, rate=50.0)
        effort = Dynamics(robot, tuple(map(parse_term, hidden))).inverse_dynamics(q, v, a)
        noise = np.random.default_rng(seed).normal(0.0, 0.05, effort.shape)
        write_log(Log(robot.joints, t, q, effort + noise), folder / name)
    return folder, robot


@pytest.fixture(scope="module")
def paths(given, cdia):
    folder, _ = given
    paths = {name.removesuffix(".csv"): folder / name for name in LOGS}
    paths |= {"urdf": next(folder.glob("*.urdf")), "model": folder / "model.json", "out": folder / "out"}
    paths["map"] = folder / "map.toml"
    paths["map"].write_text(f'[robots.one]\nrobot = "{paths["urdf"].name}"\nlogs = ["run.csv"]\n')
    made = cdia(
        "add", "coulomb_friction@only", paths["run"], "--robot", paths["urdf"], "--save", paths["model"]
    )
    assert made.code == 0, made.err
    return paths


def test_no_command_is_left_out():
    assert {*COMMANDS, *WITHOUT_A_ROBOT, *NEEDS_MORE_JOINTS, *MANY_RUNS, "app"} == {
        *typer.main.get_command(app).commands
    }


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_works_with_an_arm_of_one_joint(cdia, paths, name, monkeypatch):
    monkeypatch.setattr(LiveView, "wait", lambda view: None)
    outcome = cdia(*(word.format(**paths) for word in COMMANDS[name].split()))
    assert outcome.code == 0, outcome.err
    assert outcome.out


def test_its_friction_is_found(cdia, paths):
    found = cdia("discover", paths["run"], "--robot", paths["urdf"], "--json", "-").json
    (effect,) = found["effects"]
    assert (effect["effect"], effect["joints"]) == ("coulomb_friction", ["only"])
    assert effect["parameters"]["level"]["value"] == pytest.approx(0.5, abs=0.05)


def test_the_app_works_with_an_arm_of_one_joint(paths):
    session = Session.load(Request(str(paths["urdf"]), paths["run"])).search().add_found()
    assert json.dumps(timeline(session))
    assert joint(session, "only")


def test_effects_of_the_whole_arm_can_be_added(given, paths):
    model = Dynamics(given[1])
    problem = Problem.of(model, [read_log(paths["run"], model.robot)], [], DiscoverySettings())
    for text in ("payload", "base_tilt", "tool_wrench", "viscous_medium", "effort_delay"):
        found = add_effect_in(problem, model, parse_effect(text, model.robot))
        assert np.isfinite(found.model.terms[0].theta).all(), text
