"""Robots, a plausible log to corrupt, and the measured logs where they are present."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from benchmarks.measured_logs.folder import folder
from cdia_pin.logs import Log, read_log
from cdia_pin.robot import RobotModel, load_robot

MEASURED = folder()
ARMS = (
    ("ur10", "ur10", None),
    ("panda", "panda", None),
    ("double_pendulum", "double_pendulum/double_pendulum.urdf", None),
    ("kuka_lwr4", "kuka_lwr4/kuka_lwr4.urdf", None),
    ("ur10e", "ur10e/ur10e.urdf", "ur10e/drive_gains.json"),
    ("ur5", "ur5", "ur5/drive_gains.json"),
)


@pytest.fixture(scope="session")
def ur5() -> RobotModel:
    return load_robot("ur5")


@pytest.fixture(scope="session")
def panda() -> RobotModel:
    return load_robot("panda")


@pytest.fixture(scope="session")
def measured() -> Path:
    if not MEASURED.is_dir():
        pytest.skip("measured logs are not at ../shared/data; they have other licences and do not ship")
    return MEASURED


@pytest.fixture(scope="session")
def measured_logs(measured: Path) -> list[tuple[Log, RobotModel]]:
    """Every measured log, with its arm."""
    out = []
    for name, robot, gains in ARMS:
        arm = load_robot(measured / robot if robot.endswith(".urdf") else robot)
        for file in sorted((measured / name).glob("*.csv")):
            if "wrench" not in file.name:
                out.append((read_log(file, arm, gains=measured / gains if gains else None), arm))
    return out


@pytest.fixture(scope="session")
def plant() -> Callable[..., Log]:
    return simulated_log


@pytest.fixture(scope="session")
def ur5_log(ur5: RobotModel) -> Log:
    return simulated_log(ur5)


@pytest.fixture(scope="session")
def panda_log(panda: RobotModel) -> Log:
    return simulated_log(panda)


def simulated_log(robot: RobotModel, *, delay: float = 0.0, seed: int = 1, noise: float = 0.01) -> Log:
    """Inverse dynamics of sums of sines with friction, rotor inertia, offset and noise, 20 s at 250 Hz."""
    rng = np.random.default_rng(seed)
    time = np.arange(5000) / 250.0
    bounds = np.array([robot.limits.lower, robot.limits.upper])
    middle = np.clip(np.where(np.isfinite(bounds).all(axis=0), bounds, 0.0).mean(axis=0), -1.5, 1.5)
    q = np.zeros((len(time), robot.n)) + middle
    v, a = np.zeros_like(q), np.zeros_like(q)
    for k in range(5):
        w = 2 * np.pi * (0.08 + 0.07 * k + 0.01 * np.arange(robot.n))
        size = 0.6 * rng.uniform(0.3, 1.0, robot.n) / (1 + k)
        angle = np.outer(time, w) + rng.uniform(0, 2 * np.pi, robot.n)
        q += size * np.sin(angle)
        v += size * w * np.cos(angle)
        a -= size * w**2 * np.sin(angle)
    effort = robot.inverse_dynamics(q, v, a)
    size = np.maximum(np.ptp(effort, axis=0), 0.5)
    rotor = np.diagonal(robot.mass_matrix(q[::100]), axis1=1, axis2=2).mean(axis=0)
    effort += size * (0.15 * np.tanh(v / 0.01) + 0.1 * v + 0.02) + 0.3 * rotor * a
    if delay:
        effort = np.column_stack([np.interp(time - delay, time, column) for column in effort.T])
    return Log(
        joints=robot.joints,
        time=time,
        position=q + 1e-5 * rng.normal(size=q.shape),
        effort=effort + noise * size * rng.normal(size=q.shape),
        velocity=v + 1e-3 * rng.normal(size=q.shape),
        source="simulated",
    )
