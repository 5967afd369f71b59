"""The files and names that the examples in the pages take for granted."""

import shutil

import pytest

from cdia_pin import Dynamics, discover, load_robot, read_log, save_model
from cdia_pin.resources import logs_dir

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
    head, *samples = (logs_dir() / "demo_ur5.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    for name in LOGS:
        (folder / name).write_text(head + "".join(samples[: len(samples) // 2]), encoding="utf-8")
    log = read_log(folder / "run.csv", robot)
    model = discover(Dynamics(robot), log).model
    for name in ("model.json", "better.json"):
        save_model(model, folder / name)
    return folder, {"robot": robot, "log": log, "model": model}


@pytest.fixture
def names(reader, monkeypatch):
    """A copy of the names; the folder is the working directory, and packages of meshes are found."""
    folder, given = reader
    monkeypatch.chdir(folder)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(given["robot"].urdf.parents[2]))
    return dict(given)
