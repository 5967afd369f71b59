"""The files and names that the examples in the pages take for granted."""

import json
import shutil

import pytest

from benchmarks.newcomer.samples import SAMPLES
from cdia_pin import Dynamics, discover, load_robot, read_log, save_model
from cdia_pin.effects import EFFECTS
from cdia_pin.resources import logs_dir
from tests.made_logs import with_velocity

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
)


@pytest.fixture(scope="session")
def reader(tmp_path_factory):
    """A folder with the files that the pages name, and the Python names that they use."""
    folder = tmp_path_factory.mktemp("reader")
    robot = load_robot(ROBOT)
    shutil.copy(robot.urdf, folder / "my_arm.urdf")
    write_formats(folder)
    head, *samples = (logs_dir() / "demo_ur5.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    for name in LOGS:
        (folder / name).write_text(head + "".join(samples[: len(samples) // 2]), encoding="utf-8")
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


@pytest.fixture
def names(reader, monkeypatch):
    """A copy of the names; the folder is the working directory, packages of meshes are found, no effect stays."""
    folder, given = reader
    vocabulary = dict(EFFECTS)
    monkeypatch.chdir(folder)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(given["robot"].urdf.parents[2]))
    yield dict(given)
    EFFECTS.clear()
    EFFECTS.update(vocabulary)
