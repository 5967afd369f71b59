"""The recordings that the tutorials begin with: arms in MuJoCo, written as the tools of their makers write them."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from benchmarks.plant import Fault, MujocoPlant, Noise, Run
from cdia_pin import RobotModel

NOISE = Noise(position_resolution=2e-5, effort_fraction=0.02)
TOOL = Fault("payload", mass=1.2, com=(0.0, 0.0, 0.06), size=0.08)
GAINS = (11.0, 11.0, 11.0, 9.0, 9.0, 9.0)  # [N·m/A], of an arm that nobody sells
GEAR = 0.04  # friction over the torque limit [1], of gears as measured arms have them
ROS, JOINT_STATE = get_typestore(Stores.ROS2_HUMBLE), "sensor_msgs/msg/JointState"


def friction(robot: RobotModel) -> list[Fault]:
    """Return Coulomb friction on every joint."""
    limits = zip(robot.joints, robot.limits.effort, strict=True)
    return [Fault("coulomb_friction", joint=joint, level=GEAR * limit) for joint, limit in limits]


def recorded(plant: MujocoPlant, faults: list[Fault], seed: int, duration: float = 24.0) -> Run:
    """Return a run of 125 Hz with velocities."""
    return plant.run(faults, duration=duration, rate=125.0, noise=NOISE, seed=seed, velocity=True, keep=False)


def ur(folder: Path) -> None:
    """Write two recordings of the controller's RTDE interface, with currents, and a file of gains."""
    plant = MujocoPlant("ur5")
    faults = [*friction(plant.robot), TOOL]
    for name, seed in (("recording.csv", 3), ("other.csv", 4)):
        log = recorded(plant, faults, seed).log
        columns = {
            "timestamp": log.time + 7000.0,
            **numbered("actual_q_{}", log.position),
            **numbered("actual_qd_{}", log.velocity),
            **numbered("actual_current_{}", log.effort / GAINS),
        }
        table(columns, folder / name, " ")
    gains = dict(zip(plant.robot.joints, GAINS, strict=True))
    (folder / "gains.json").write_text(json.dumps(gains, indent=1), encoding="utf-8")


def franka(folder: Path) -> None:
    """Write two recordings of libfranka: torques behind the gears, and on the second day a tool."""
    plant = MujocoPlant("panda")
    for name, seed, faults in (("monday.csv", 5, []), ("friday.csv", 6, [TOOL])):
        log = recorded(plant, faults, seed).log
        columns = {
            "time": np.round(1e3 * log.time),
            **numbered("state.q[{}]", log.position),
            **numbered("state.dq[{}]", log.velocity),
            **numbered("state.tau_J[{}]", log.effort),
        }
        table(columns, folder / name, ",")


def ros(folder: Path) -> None:
    """Write a bag of /joint_states whose messages sort the joints by the alphabet, beside a gripper."""
    plant = MujocoPlant("ur5")
    log = recorded(plant, [*friction(plant.robot), TOOL], seed=8).log
    types = ROS.types
    order = np.argsort(log.joints)
    names = [*(log.joints[k] for k in order), "gripper_joint"]
    with Writer(folder / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as bag:
        topic = bag.add_connection("/joint_states", JOINT_STATE, typestore=ROS)
        for k, stamp in enumerate(np.round(1e9 * log.time).astype(int).tolist()):
            time = types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
            header = types["std_msgs/msg/Header"](stamp=time, frame_id="")
            signals = (np.append(s[k, order], 0.0) for s in (log.position, log.velocity, log.effort))
            message = types[JOINT_STATE](header, names, *signals)
            bag.write(topic, stamp, ROS.serialize_cdr(message, JOINT_STATE))


def numbered(name: str, signal: np.ndarray | None) -> dict[str, np.ndarray]:
    """Return a column for each joint, by a name with the joint's number."""
    assert signal is not None
    return {name.format(k): column for k, column in enumerate(signal.T)}


def table(columns: Mapping[str, np.ndarray], path: Path, delimiter: str) -> None:
    """Write columns of one length as text."""
    rows = np.column_stack(list(columns.values()))
    np.savetxt(path, rows, fmt="%.6f", delimiter=delimiter, header=delimiter.join(columns), comments="")


SAMPLES: Mapping[str, Callable[[Path], None]] = {"ur": ur, "franka": franka, "ros": ros}
