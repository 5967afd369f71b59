"""Measured logs and their halves, each with its arm."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import lru_cache
from pathlib import Path

from benchmarks.measured_logs.cases import halves
from benchmarks.measured_logs.folder import BESIDE, VARIABLE
from cdia_pin.logs import Log, read_log
from cdia_pin.robot import RobotModel, load_robot


class Part(StrEnum):
    """How much of a log is used."""

    WHOLE = "whole"
    FIRST = "first half"
    SECOND = "second half"


@dataclass(frozen=True)
class MeasuredArm:
    """An arm whose logs are there.

    Attributes:
        name: Its name, and its folder.
        robot: Name in the catalogue, or a URDF relative to the data.
        gains: File of drive gains relative to the data, where its logs have currents.
        behind_gear: Whether its torque sensors are behind the gears and cannot see the motors, as its README says.
        folder: Its folder, if that has another name.
        torque_side: Side of the gear on which its torque was measured, as its user says it to the program.
    """

    name: str
    robot: str
    gains: str = ""
    behind_gear: bool = False
    folder: str = ""
    torque_side: str | None = None


ARMS = {
    a.name: a
    for a in (
        MeasuredArm("panda", "panda"),
        MeasuredArm("ur10", "ur10"),
        MeasuredArm("ur10e", "ur10e/ur10e.urdf", "ur10e/drive_gains.json"),
        MeasuredArm("ur5", "ur5", "ur5/drive_gains.json"),
        MeasuredArm("kuka_lwr4", "kuka_lwr4/kuka_lwr4.urdf", behind_gear=True),
        MeasuredArm("double_pendulum", "double_pendulum/double_pendulum.urdf"),
    )
}


@dataclass(frozen=True)
class Recording:
    """A measured log, or half of one.

    Attributes:
        arm: Name of the arm.
        file: Name of the log without its suffix.
        part: How much of it.
    """

    arm: str
    file: str
    part: Part = Part.WHOLE

    @property
    def id(self) -> str:
        """Name that stays the same, such as ``ur10e/fourier_50s, first half``."""
        return f"{self.arm}/{self.file}" + ("" if self.part is Part.WHOLE else f", {self.part}")

    @property
    def robot(self) -> RobotModel:
        """The arm's description."""
        return robot_of(self.arm)

    def read(self) -> Log:
        """Return the log."""
        whole = _read(self.arm, self.file)
        first, second = halves(whole)
        part = {Part.WHOLE: whole, Part.FIRST: first, Part.SECOND: second}[self.part]
        return replace(part, source=self.id)

    def halves(self) -> tuple[Recording, Recording]:
        """Return both halves."""
        return replace(self, part=Part.FIRST), replace(self, part=Part.SECOND)


def data_folder() -> Path:
    """Return the folder of the measured logs."""
    return Path(os.environ.get(VARIABLE, BESIDE))


@lru_cache(maxsize=8)
def robot_of(arm: str) -> RobotModel:
    """Return the description of an arm; the same one each time."""
    given = ARMS[arm].robot
    return load_robot(data_folder() / given if given.endswith(".urdf") else given)


@lru_cache(maxsize=4)
def _read(arm: str, file: str) -> Log:
    given = ARMS[arm]
    path = data_folder() / (given.folder or arm) / f"{file}.csv"
    gains = data_folder() / given.gains if given.gains else None
    return read_log(path, robot_of(arm), gains=gains, torque_side=given.torque_side)
