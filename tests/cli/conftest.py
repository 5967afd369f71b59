"""The command run in this process, and small logs for it to read."""

import contextlib
import io
import json
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.measured_logs.folder import folder
from cdia_pin import Dynamics, load_robot, write_log
from cdia_pin.cli import main
from cdia_pin.effects import parse_term
from cdia_pin.logs import Log

MEASURED = folder()

HIDDEN = "coulomb_friction@joint2: level=0.05"


@dataclass(frozen=True)
class Outcome:
    """What a run of the command left."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        return json.loads(self.out)

    @property
    def error(self) -> str:
        """The one line that a failure is told in."""
        assert self.code == 2, (self.code, self.out, self.err)
        assert "Traceback" not in self.err
        *before, last = self.err.splitlines()
        assert last.startswith("cdia: error: "), self.err
        assert all(line.startswith("cdia: warning: ") for line in before), self.err
        return last.removeprefix("cdia: error: ")


def run(*arguments: object) -> Outcome:
    """Run ``cdia`` with these arguments."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
        code = main([str(a) for a in arguments])
    return Outcome(code, out.getvalue(), err.getvalue())


def motion(n: int, seed: int, duration: float = 20.0, rate: float = 100.0) -> tuple[np.ndarray, ...]:
    """Time, and positions, speeds and accelerations of sums of sines, with their exact derivatives."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, duration, 1.0 / rate)
    f = 2 * np.pi * rng.uniform(0.1, 0.9, (4, n))
    size, phase = rng.uniform(0.2, 0.5, (4, n)), rng.uniform(0, 2 * np.pi, (4, n))
    angle = t[:, None, None] * f + phase
    q = (size * np.sin(angle)).sum(axis=1)
    v = (size * f * np.cos(angle)).sum(axis=1)
    a = -(size * f**2 * np.sin(angle)).sum(axis=1)
    return t, q, v, a


def pendulum_log(seed: int, *hidden: str) -> Log:
    """A double pendulum with effects; the commands are tested here, not whether effects are found."""
    robot = load_robot("double_pendulum")
    t, q, v, a = motion(robot.n, seed)
    plant = Dynamics(robot, tuple(parse_term(h) for h in hidden))
    effort = plant.inverse_dynamics(q, v, a)
    noise = np.random.default_rng(seed + 1).normal(0.0, 0.01 * effort.std(axis=0), effort.shape)
    return Log(robot.joints, t, q, effort + noise)


@pytest.fixture(scope="session")
def cdia() -> Callable[..., Outcome]:
    return run


@pytest.fixture(scope="session")
def logs(tmp_path_factory) -> Path:
    """Folder of logs: ``run.csv``, ``other.csv`` (with friction), ``clean.csv`` (as the URDF says)."""
    folder = tmp_path_factory.mktemp("logs")
    write_log(pendulum_log(1, HIDDEN), folder / "run.csv")
    write_log(pendulum_log(2, HIDDEN), folder / "other.csv")
    write_log(pendulum_log(3), folder / "clean.csv")
    return folder


@pytest.fixture(scope="session")
def log(logs) -> Path:
    return logs / "run.csv"


@pytest.fixture(scope="session")
def measured() -> Path:
    if not MEASURED.is_dir():
        pytest.skip("measured logs are not at ../shared/data; they have other licences and do not ship")
    return MEASURED
