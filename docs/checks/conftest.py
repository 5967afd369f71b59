"""The files and names that the examples in the pages take for granted."""

import json
import shutil
from functools import cache, partial

import pytest

from benchmarks.newcomer.samples import SAMPLES
from cdia_pin import Dynamics, discover, load_robot, read_log, save_model, write_log
from cdia_pin.effects import EFFECTS, parse_term
from cdia_pin.resources import logs_dir
from tests.made_logs import make, with_velocity

ROBOT = "ur5"  # the arm of the log that ships
LOGS = (
    "run.csv",
    "other.csv",
    "before.csv",
    "monday.csv",
    "friday.csv",
    "cold.csv",
    "warm1.csv",
    "warm2.csv",
    "pool.csv",
    "free.csv",
    "pressing.csv",
    "cell-3/2026-05-11.csv",
    "cell-3/2026-05-12.csv",
)
SAMPLES_KEPT = 1000  # of the log that ships [samples], 8 s: the pages show how, not how well
FLEET = '[robots.cell-3]\nrobot = "ur5"\nlogs = ["cell-3/*.csv"]\n'
KNOWN = "payload: mass=2.6, first_moment_z=0.2"  # what docs/identify.md weighs


@pytest.fixture(scope="session")
def reader(tmp_path_factory):
    """A folder with the files that the pages name, and the Python names that they use."""
    folder = tmp_path_factory.mktemp("reader")
    robot = load_robot(ROBOT)
    shutil.copy(robot.urdf, folder / "my_arm.urdf")
    write_formats(folder)
    head, *samples = (logs_dir() / "demo_ur5.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    (folder / "cell-3").mkdir()
    for name in LOGS:
        (folder / name).write_text(head + "".join(samples[:SAMPLES_KEPT]), encoding="utf-8")
    (folder / "fleet.toml").write_text(FLEET)
    write_weighed(folder, robot)
    log = read_log(folder / "run.csv", robot)
    model = discover(Dynamics(robot), log).model
    for name in ("model.json", "better.json"):
        save_model(model, folder / name)
    return folder, {"robot": robot, "log": log, "model": model}


def write_formats(folder):
    """Write a recording in each format that docs/formats has a page on."""
    for sample in SAMPLES.values():
        sample.write(folder, with_velocity(load_robot(sample.robot)))
    (folder / "gains.json").write_text(json.dumps(dict.fromkeys(load_robot("ur10").joints, 10.0)))


def write_weighed(folder, robot):
    """Write a log with a payload of known mass, one without, and nominal gains."""
    loaded = Dynamics(robot, (parse_term(KNOWN),))
    for seed, (name, model) in enumerate({"loaded": loaded, "unloaded": Dynamics(robot)}.items()):
        missing = partial(lambda model, *x: robot.inverse_dynamics(*x) - model.inverse_dynamics(*x), model)
        write_log(make(robot, missing, seed=seed, noise=0.02).log, folder / f"{name}.csv")
    (folder / "nominal.json").write_text(json.dumps(dict.fromkeys(robot.joints, 10.0)))


@pytest.fixture(scope="session")
def folder_of(reader, tmp_path_factory):
    """The folder of a page, so that what one page writes is not read by another."""
    return cache(lambda page: shutil.copytree(reader[0], tmp_path_factory.mktemp(page.stem) / "reader"))


@pytest.fixture
def names(reader, folder_of, page, monkeypatch):
    """A copy of the names; the folder is the page's, packages of meshes are found, no effect stays."""
    given = reader[1]
    vocabulary = dict(EFFECTS)
    monkeypatch.chdir(folder_of(page))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(given["robot"].urdf.parents[2]))
    yield dict(given)
    EFFECTS.clear()
    EFFECTS.update(vocabulary)
