"""A small fleet: logs of the SCARA arm, whose friction is known, with dates in their names."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from cdia_pin import load_robot, write_log
from tests.made_logs import make

LEVEL = 0.8  # [N·m] of joint2
DAYS = 3


@dataclass(frozen=True)
class SmallFleet:
    """A map with its logs."""

    map: Path
    logs: tuple[Path, ...]


def rubbing(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    f = np.zeros_like(v)
    f[:, 1] = -LEVEL * np.sign(v[:, 1])
    return f


@pytest.fixture(scope="session")
def small_fleet(tmp_path_factory) -> SmallFleet:
    folder = tmp_path_factory.mktemp("fleet")
    robot = load_robot("scara")
    (folder / "arm-1").mkdir()
    logs = []
    for day in range(DAYS):
        log = make(robot, rubbing, seed=day, duration=12.0, noise=0.02).log
        warm = replace(log, temperature=np.full_like(log.position, 25.0 + day))
        logs.append(write_log(warm, folder / "arm-1" / f"2026-05-{day + 10}.csv"))
    path = folder / "fleet.toml"
    path.write_text('[robots.arm-1]\nrobot = "scara"\nlogs = ["arm-1/*.csv"]\n', encoding="utf-8")
    return SmallFleet(path, tuple(logs))
