"""The logs of a simulated fleet, recorded in MuJoCo and kept as Parquet files."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from benchmarks.fleet.plan import ARM, LINKS, FleetRobotPlan
from benchmarks.plant import Fourier, MujocoPlant
from benchmarks.plant.model_error import erroneous
from cdia_pin.logs import write_log
from cdia_pin.whole_files import write_whole

DURATION, RATE = 8.0, 100.0  # [s], [Hz]: thousands of logs have to be cheap
STEP = 2e-3  # [s] of the integration
SLOWEST, FASTEST = 0.6, 1.0  # largest speed of a day's motion over what the joints may do [1]
THERMOMETER = 0.5  # [K], its quantum and the standard deviation of its error


@dataclass(frozen=True)
class Recording:
    """A log that is to be recorded.

    Attributes:
        robot: The robot.
        day: The day.
        folder: Where the fleet's logs are.
    """

    robot: FleetRobotPlan
    day: int
    folder: Path

    @property
    def path(self) -> Path:
        """The log's file; its name is its date."""
        return self.folder / self.robot.name / f"{self.robot.date(self.day):%Y-%m-%dT%H%M}.parquet"


@lru_cache(maxsize=4)
def plant_of(seed: int) -> MujocoPlant:
    """Return a robot's arm, whose links are not quite those of its URDF."""
    nominal = MujocoPlant(ARM, step=STEP)
    return MujocoPlant(ARM, step=STEP, inertias=erroneous(nominal.nominal.file.inertias, LINKS, seed))


def record(one: Recording) -> Path:
    """Record a log, unless it is there already.

    Args:
        one: The log.
    """
    if one.path.exists():
        return one.path
    plant = plant_of(one.robot.seed)
    rng = np.random.default_rng([one.robot.seed, 5, one.day])
    seed = int(rng.integers(2**31))
    motion = Fourier(base=float(rng.uniform(0.1, 0.16)), speed=float(rng.uniform(SLOWEST, FASTEST)))
    faults = one.robot.faults(one.day, plant.joints)
    run = plant.run(faults, motion=motion, duration=DURATION, rate=RATE, seed=seed, keep=False)
    warm = one.robot.temperature[one.day] + THERMOMETER * rng.standard_normal(len(plant.joints))
    read = np.round(warm / THERMOMETER) * THERMOMETER
    log = replace(run.log, temperature=np.tile(read, (len(run.log.time), 1)))
    one.path.parent.mkdir(parents=True, exist_ok=True)
    return write_log(log, one.path)


def recordings(robots: Iterable[FleetRobotPlan], folder: Path) -> list[Recording]:
    """Return all logs of a fleet, day by day.

    Args:
        robots: The robots.
        folder: Where the logs are.
    """
    return [Recording(r, day, folder) for r in robots for day in range(r.days)]


def write_map(robots: Iterable[FleetRobotPlan], folder: Path) -> Path:
    """Write the map of a fleet.

    Args:
        robots: The robots.
        folder: Where the logs are.
    """
    path = folder / "fleet.toml"
    folder.mkdir(parents=True, exist_ok=True)
    lines = (f'[robots.{r.name}]\nrobot = "{ARM}"\nlogs = ["{r.name}/*.parquet"]\n' for r in robots)
    return write_whole(path, "\n".join(lines))
