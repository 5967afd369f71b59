"""What the columns of a log hold, for whoever maps them to the signals and joints of a robot."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

from cdia_pin.app.inputs import Request
from cdia_pin.errors import LogError
from cdia_pin.logs.columns import ColumnNames
from cdia_pin.logs.conversion import conversions_in
from cdia_pin.logs.formats import column_patterns
from cdia_pin.logs.formats.guess import ColumnGuess, reading_of
from cdia_pin.logs.joint_names import joint_map_of, match_joints
from cdia_pin.logs.log_reader import choice_of
from cdia_pin.logs.readers.dispatch import Wanted, read_table
from cdia_pin.robot import RobotModel


@dataclass(frozen=True)
class LogColumns:
    """The joints and signals of a log.

    Attributes:
        labels: Names of joints, as the log has them.
        currents: Whether there are motor currents and no torques: drive gains are needed.
        guesses: What columns of unknown names may hold; empty where the names are known.
    """

    labels: tuple[str, ...]
    currents: bool
    guesses: tuple[ColumnGuess, ...] = ()

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


def columns_of(
    asked: Request, joints: Sequence[str], guesses: Sequence[ColumnGuess] = ()
) -> LogColumns | None:
    """Return what the columns of a log hold; None if they cannot be read as asked.

    Args:
        asked: The log, and how to read it.
        joints: Joints of the robot, by which the topic of a bag is chosen.
        guesses: What columns of unknown names may hold.
    """
    own = {g.signal: g.pattern for g in guesses if g.signal} | dict(asked.columns)
    try:
        table, _ = read_table(asked.log, joints, Wanted(asked.format, asked.joint_map, episode=asked.episode))
        names: ColumnNames = choice_of(table, asked.format, own, asked.log.name, joints).columns
    except LogError:
        return None
    of_motion = dict.fromkeys(
        label for signal in ("position", "effort", "current") for label in names.labels(signal)
    )
    currents = bool(names.labels("current")) and not names.labels("effort")
    return LogColumns(tuple(of_motion), currents, tuple(guesses))


def as_guessed(asked: Request, guesses: Sequence[ColumnGuess], robot: RobotModel) -> Request:
    """Return a request that reads columns of unknown names as guessed; what the user said comes first.

    Args:
        asked: What was asked for.
        guesses: What columns of unknown names may hold.
        robot: The arm.
    """
    reading = reading_of(guesses, robot)
    columns = column_patterns(reading["columns"], one_joint=robot.n == 1) if "columns" in reading else {}
    joints = joint_map_of(reading["joint_map"]) if "joint_map" in reading else {}
    guessed = replace(asked, columns=columns | dict(asked.columns), joint_map=joints | dict(asked.joint_map))
    for option in conversions_in(reading["convert"]) if "convert" in reading else ():
        if option.partition("=")[0] not in asked.convert:
            guessed = guessed.converted(option)
    return guessed
