"""The wheel carries everything that it needs: robots and logs are found away from the checkout."""

import importlib.util
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
NO_NETWORK = re.compile(
    r"No matching distribution found for hatchling|Temporary failure|Network is unreachable|"
    r"Failed to establish a new connection|Connection refused|Could not fetch URL",
    re.IGNORECASE,
)

QUESTIONS = """
import json
import cdia_pin
from cdia_pin.resources import logs_dir, robots_dir
from cdia_pin.robot import catalogue, load_robot
scara = load_robot("scara")
print(json.dumps({
    "package": cdia_pin.__file__,
    "robots": str(robots_dir()),
    "logs": str(logs_dir()),
    "joints": scara.joints,
    "gravity": list(scara.gravity_vector),
    "names": list(catalogue()),
}))
"""


def pip(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


@pytest.fixture(scope="module")
def installed(tmp_path_factory) -> Path:
    if importlib.util.find_spec("pip") is None:
        pytest.skip("this environment has no pip to build a wheel with")
    folder = tmp_path_factory.mktemp("wheel")
    # Building in isolation fetches hatchling; with hatchling here nothing needs to be fetched.
    isolation = ["--no-build-isolation"] if importlib.util.find_spec("hatchling") else []
    built = pip("wheel", str(ROOT), "--no-deps", "--wheel-dir", str(folder), *isolation)
    if built.returncode and NO_NETWORK.search(built.stderr + built.stdout):
        pytest.skip("hatchling is not installed and cannot be fetched: no network")
    assert built.returncode == 0, built.stderr
    (wheel,) = folder.glob("cdia_pin-*.whl")
    target = folder / "site"
    done = pip("install", "--no-deps", "--no-index", "--target", str(target), str(wheel))
    assert done.returncode == 0, done.stderr
    return target


@pytest.fixture(scope="module")
def answers(installed, tmp_path_factory) -> dict:
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    environment = {**os.environ, "PYTHONPATH": str(installed)}
    command = [sys.executable, "-c", QUESTIONS]
    run = subprocess.run(
        command, capture_output=True, text=True, cwd=elsewhere, env=environment, timeout=60, check=False
    )
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout)


def test_what_is_imported_is_the_wheel(answers, installed):
    assert Path(answers["package"]).is_relative_to(installed)


def test_robots_and_logs_are_found_inside_it(answers, installed):
    for folder in ("robots", "logs"):
        assert Path(answers[folder]).is_relative_to(installed)
    assert {p.name for p in Path(answers["robots"]).iterdir()} >= {"robots.toml", "scara.urdf"}
    assert "ur5" in answers["names"]


def test_every_shipped_log_is_in_it(answers):
    shipped = {
        p.relative_to(ROOT / "examples/data") for p in (ROOT / "examples/data").rglob("*") if p.is_file()
    }
    found = {p.relative_to(answers["logs"]) for p in Path(answers["logs"]).rglob("*") if p.is_file()}
    assert found == shipped


def test_the_shipped_robot_loads(answers):
    assert answers["joints"] == ["joint1", "joint2", "joint3", "joint4"]
    assert answers["gravity"] == [0.0, 0.0, -9.8]


def test_types_and_public_names_are_in_it(installed):
    package = installed / "cdia_pin"
    assert (package / "py.typed").is_file()
    assert (package / "__init__.pyi").is_file()


def test_licence_and_command_are_declared(installed):
    (metadata,) = installed.glob("cdia_pin-*.dist-info")
    assert "License-Expression: BSD-3-Clause" in (metadata / "METADATA").read_text()
    assert "cdia = cdia_pin.cli:main" in (metadata / "entry_points.txt").read_text()
