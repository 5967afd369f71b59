"""What is fitted and what is held out: the halves of a log, or two motions of one arm."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.measured_logs.jobs import GAINS, UR10E
from cdia_pin.logs import Log, read_log
from cdia_pin.robot import RobotModel, load_robot


@dataclass(frozen=True)
class Case:
    """Two logs of one arm.

    Attributes:
        name: What the tables call it.
        arm: The arm.
        robot: Its description.
        fitted: The log that is fitted.
        unseen: The log that is only predicted.
        published: Held-out errors that the data's README gives for least squares with the full inertial regressor,
            friction and rotors, in % of the RMS torque of each joint.
    """

    name: str
    arm: str
    robot: RobotModel
    fitted: Log
    unseen: Log
    published: tuple[float, ...]


def cases(data: Path) -> Iterator[Case]:
    """Yield the cases of the data's README.

    Args:
        data: Folder of the measured logs.
    """
    for arm, published in (("panda", (9, 1.2, 2.2, 1.2, 6, 7, 22)), ("ur10", (18, 5, 6, 15, 13, 30))):
        robot = load_robot(arm)
        log = read_log(data / arm / "exciting.csv", robot)
        yield Case(f"{arm}, halves", arm, robot, *halves(log), published)
    robot = load_robot(data / UR10E)
    long, short = (
        read_log(data / "ur10e" / f"fourier_{s}.csv", robot, gains=data / GAINS) for s in ("50s", "40s")
    )
    yield Case("ur10e, 50 s → 40 s", "ur10e", robot, long, short, (10, 6, 5, 10, 11, 17))
    yield Case("ur10e, 50 s halves", "ur10e", robot, *halves(long), (8, 7, 4, 9, 17, 10))


def halves(log: Log) -> tuple[Log, Log]:
    """Return the first and the second half of a log's time."""
    middle = int(np.searchsorted(log.time, (log.time[0] + log.time[-1]) / 2))
    return log.slice(0, middle), log.slice(middle, len(log.time))
