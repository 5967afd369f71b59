"""The recordings that the tutorials begin with: arms in MuJoCo, written as the tools of their makers write them."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path

from benchmarks.newcomer.samples import GAINS, NOISE, TOOL, friction
from benchmarks.plant import Fault, MujocoPlant, Run
from benchmarks.recordings import libfranka, ros2, rtde, write


def recorded(plant: MujocoPlant, faults: list[Fault], seed: int, duration: float = 24.0) -> Run:
    """Return a run of 125 Hz with velocities."""
    return plant.run(faults, duration=duration, rate=125.0, noise=NOISE, seed=seed, velocity=True, keep=False)


def ur(folder: Path) -> None:
    """Write two recordings of the controller's RTDE interface, with currents, and a file of gains."""
    plant = MujocoPlant("ur5")
    faults = [*friction(plant.robot), TOOL]
    for name, seed in (("recording.csv", 3), ("other.csv", 4)):
        log = recorded(plant, faults, seed).log
        write(folder / name, rtde(log, actual_current=log.effort / GAINS), " ")
    gains = dict(zip(plant.robot.joints, GAINS, strict=True))
    (folder / "gains.json").write_text(json.dumps(gains, indent=1), encoding="utf-8")


def franka(folder: Path) -> None:
    """Write two recordings of libfranka: torques behind the gears, and on the second day a tool."""
    plant = MujocoPlant("panda")
    for name, seed, faults in (("monday.csv", 5, []), ("friday.csv", 6, [TOOL])):
        log = recorded(plant, faults, seed).log
        write(folder / name, libfranka(log))


def ros(folder: Path) -> None:
    """Write a bag of /joint_states."""
    plant = MujocoPlant("ur5")
    ros2(folder / "bag", recorded(plant, [*friction(plant.robot), TOOL], seed=8).log)


SAMPLES: Mapping[str, Callable[[Path], None]] = {"ur": ur, "franka": franka, "ros": ros}
