"""The state of a store: how many logs of which robot it holds."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from cdia_pin import schemas
from cdia_pin.fleet.course import courses_of
from cdia_pin.fleet.store import FleetStore


@dataclass(frozen=True)
class RobotStatus:
    """What a store holds of a robot.

    Attributes:
        robot: Name of the robot.
        logs: Number of its logs, failed ones included.
        failed: Reason by name of the log that gave nothing.
        outdated: Number of logs that were added with another setup, or by another version, only.
        first: When the first log was recorded; None if it is not known.
        last: When the last one was.
    """

    robot: str
    logs: int
    failed: dict[str, str]
    outdated: int
    first: datetime | None
    last: datetime | None


@dataclass(frozen=True)
class FleetStatus:
    """What a store holds.

    Attributes:
        robots: The robots, by name.
    """

    robots: tuple[RobotStatus, ...]

    def to_dict(self) -> dict[str, object]:
        """Return the status for JSON."""
        return {
            "schema": schemas.FLEET,
            "robots": [
                {
                    "robot": r.robot,
                    "logs": r.logs,
                    "failed": r.failed,
                    "outdated": r.outdated,
                    "first": r.first and r.first.isoformat(),
                    "last": r.last and r.last.isoformat(),
                }
                for r in self.robots
            ],
        }


def fleet_status(store: FleetStore) -> FleetStatus:
    """Return what a store holds.

    Args:
        store: The store.

    Raises:
        FleetError: If it cannot be read.
    """
    out = []
    for r in courses_of(store):
        times = [at for c in r.courses for at in c.recorded if at is not None]
        first, last = min(times, default=None), max(times, default=None)
        out.append(RobotStatus(r.robot, r.logs, r.failed, r.outdated, first, last))
    return FleetStatus(tuple(out))
