"""What the columns of a log hold, for whoever maps them to the joints of a robot."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cdia_pin.errors import LogError
from cdia_pin.logs.columns import sort_names
from cdia_pin.logs.joint_names import match_joints
from cdia_pin.logs.readers.dispatch import Wanted, read_table


@dataclass(frozen=True)
class LogColumns:
    """The joints and signals of a log.

    Attributes:
        labels: Names of joints, as the log has them.
        currents: Whether there are motor currents and no torques: drive gains are needed.
    """

    labels: tuple[str, ...]
    currents: bool

    def proposed(self, joints: Sequence[str]) -> dict[str, str]:
        """Return a name in the log for each joint of which it has none: in its order, where the numbers fit.

        Args:
            joints: Joints of the robot.

        Returns:
            Name by joint; empty where the reader finds the joints by itself.
        """
        with contextlib.suppress(LogError):
            match_joints(self.labels, joints)
            return {}
        left = [label for label in self.labels if label not in joints]
        without = [joint for joint in joints if joint not in self.labels]
        return dict(zip(without, left, strict=True)) if len(left) == len(without) else {}


def columns_of(path: Path, joints: Sequence[str]) -> LogColumns | None:
    """Return what the columns of a log hold; None if it is no log.

    Args:
        path: The log.
        joints: Joints of the robot, by which the topic of a bag is chosen.
    """
    try:
        table, _ = read_table(path, joints, Wanted())
    except LogError:
        return None
    names = sort_names((*table.columns, *table.not_numbers))
    of_motion = dict.fromkeys(
        label for signal in ("position", "effort", "current") for label in names.labels(signal)
    )
    return LogColumns(tuple(of_motion), bool(names.labels("current")) and not names.labels("effort"))
