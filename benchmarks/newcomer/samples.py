"""The recordings that the pages of docs/formats name, each in its format."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.plant import Fault, MujocoPlant, Noise
from benchmarks.recordings import lerobot, libfranka, numbered, ros2, rtde, velocity_of, write
from cdia_pin import Log, RobotModel, write_log

SECONDS = 24.0  # [s]
NOISE = Noise(position_resolution=2e-5, effort_fraction=0.02)
TOOL = Fault("payload", mass=1.2, com=(0.0, 0.0, 0.06), size=0.08)
GEAR = 0.04  # friction over the torque limit [1], of gears as measured arms have them
GAINS = (
    11.0,
    11.0,
    11.0,
    9.0,
    9.0,
    9.0,
)  # [N·m/A], those of docs/formats/rtde.md; of an arm that nobody sells


def friction(robot: RobotModel) -> list[Fault]:
    """Return Coulomb friction on every joint."""
    limits = zip(robot.joints, robot.limits.effort, strict=True)
    return [Fault("coulomb_friction", joint=joint, level=GEAR * limit) for joint, limit in limits]


@dataclass(frozen=True)
class Sample:
    """A recording of an arm that carries a tool.

    Attributes:
        robot: Name of the arm.
        rate: Samples a second [Hz], as the recorder of the format has them.
        geared: Whether friction of gears is in the torque.
        write: From a folder and a log to the files.
    """

    robot: str
    rate: float
    geared: bool
    write: Callable[[Path, Log], object]

    def log(self, seed: int) -> Log:
        """Return a run of the arm in MuJoCo.

        Args:
            seed: Of motion and noise.
        """
        plant = MujocoPlant(self.robot)
        faults = [*(friction(plant.robot) if self.geared else ()), TOOL]
        run = plant.run(
            faults, duration=SECONDS, rate=self.rate, noise=NOISE, seed=seed, velocity=True, keep=False
        )
        return run.log


def ur_recording(folder: Path, log: Log) -> None:
    """Write what UR's client records, columns separated by blanks."""
    torques = {"actual_current": log.effort / GAINS, "target_moment": log.effort}
    write(folder / "robot_data.csv", rtde(log, **torques), " ")


def franka_log(folder: Path, log: Log) -> None:
    """Write what a control loop of libfranka keeps."""
    write(folder / "franka.csv", libfranka(log))


def bag(folder: Path, log: Log) -> None:
    """Write a ROS 2 bag."""
    ros2(folder / "bag", log)


def dataset(folder: Path, log: Log) -> None:
    """Write a LeRobot dataset of two episodes, in degrees."""
    parts = [joint.removesuffix("_joint") for joint in log.joints]
    names = [f"{part}.{signal}" for signal in ("pos", "vel", "torque") for part in parts]
    values = np.column_stack([np.degrees(log.position), np.degrees(velocity_of(log)), log.effort])
    lerobot(folder / "dataset", log, names, values, episodes=2)


def tables(folder: Path, log: Log) -> None:
    """Write a CSV in the project's own dialect, and one with names of somebody's own, in degrees."""
    write_log(log, folder / "run.csv")
    columns = {
        "t": log.time,
        **numbered("J", np.degrees(log.position), "{}{} ang"),
        **numbered("J", np.degrees(velocity_of(log)), "{}{} spd"),
        **numbered("J", log.effort, "{}{} mom"),
    }
    write(folder / "plc.csv", columns)


SAMPLES: Mapping[str, Sample] = {
    "rtde": Sample("ur10", 125.0, True, ur_recording),
    "libfranka": Sample("panda", 1000.0, False, franka_log),
    "ros2": Sample("ur5", 125.0, True, bag),
    "lerobot": Sample("ur5", 50.0, True, dataset),
    "csv": Sample("ur5", 125.0, True, tables),
}
"""By the name of the page in docs/formats."""
