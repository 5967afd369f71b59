"""The setup of a robot, loaded: its model, how its logs are read, and the hash of all that decides."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from cdia_pin.dynamics import Dynamics, load_model
from cdia_pin.fleet.fleet_map import FleetRobot
from cdia_pin.logs import Log, read_log
from cdia_pin.robot import load_robot

KEPT = 8  # robots that a process keeps loaded [1]; models that remember their logs have megabytes


@dataclass(frozen=True)
class RobotSetup:
    """A robot of a fleet, loaded.

    Attributes:
        robot: The robot as the map states it.
        model: Its model.
        hash: Hash of its URDF, model, gains, options of reading and settings.
    """

    robot: FleetRobot
    model: Dynamics
    hash: str

    @property
    def settings(self) -> str:
        """The settings of the fit, JSON."""
        return json.dumps(asdict(self.robot.settings), sort_keys=True)

    def read(self, log: Path) -> Log:
        """Read a log of this robot.

        Args:
            log: Its path.

        Raises:
            LogError: If it cannot be read.
        """
        options: dict[str, Any] = dict(self.robot.reading)
        return read_log(log, self.model.robot, gains=self.robot.gains, **options)


@lru_cache(maxsize=KEPT)
def load_setup(robot: FleetRobot) -> RobotSetup:
    """Load a robot of a fleet; a process loads it once.

    Args:
        robot: The robot as the map states it.

    Raises:
        CdiaError: If its description, model or gains cannot be read.
    """
    arm = load_robot(robot.robot)
    model = Dynamics(arm) if robot.model is None else load_model(robot.model, arm)
    digest = sha256(repr((robot.reading, robot.settings)).encode())
    for path in (arm.urdf, robot.model, robot.gains):
        digest.update(b"\0" if path is None else path.read_bytes())
    return RobotSetup(robot, model, digest.hexdigest())
