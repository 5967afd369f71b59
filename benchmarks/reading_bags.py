"""Measure how many JointState messages a second are read from ROS 2 bags.

Usage:
    python -m benchmarks.reading_bags               # 300,000 messages of each kind of bag
    python -m benchmarks.reading_bags --messages 50000

A bag is made of an arm with seven joints, beside a gripper on another topic. The time is the processor's for
`read_log` as a whole, with the checksum of the file, in a process that has read a bag before.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from cdia_pin import load_robot, read_log

WANTED = 250_000  # [1/s], an hour of an arm at 1 kHz in 15 s
JOINT_STATE = "sensor_msgs/msg/JointState"
GRIPPER_EVERY = 10  # [messages] of the arm for each one of the gripper
KINDS = {
    "MCAP": (StoragePlugin.MCAP, None),
    "MCAP, zstd": (StoragePlugin.MCAP, CompressionFormat.ZSTD),
    "db3": (StoragePlugin.SQLITE3, None),
}
REPEATS = 3


def main() -> None:
    """Print a line for each kind of bag."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.reading_bags", description=__doc__.split("\n")[0]
    )
    given.add_argument("--messages", type=int, default=300_000, help="messages in a bag")
    count = given.parse_args().messages
    for kind, rate in rates(count):
        met = "" if rate >= WANTED else f", less than {WANTED:,}"
        print(f"{kind:12s} {count:,} messages, {rate:,.0f} a second{met}", flush=True)


def rates(count: int) -> Iterator[tuple[str, float]]:
    """Yield how many messages a second are read from each kind of bag.

    Args:
        count: Messages in a bag.
    """
    robot = load_robot("panda")
    with tempfile.TemporaryDirectory() as folder:
        for kind, (plugin, compression) in KINDS.items():
            bag = write_bag(Path(folder) / kind, plugin, compression, robot.joints, count)
            read_log(
                write_bag(Path(folder) / f"{kind}, short", plugin, compression, robot.joints, 100), robot
            )
            seconds = []
            for _ in range(REPEATS):
                start = time.process_time()
                log = read_log(bag, robot)
                seconds.append(time.process_time() - start)
            yield kind, len(log.time) / min(seconds)


def write_bag(
    path: Path,
    plugin: StoragePlugin,
    compression: CompressionFormat | None,
    joints: tuple[str, ...],
    count: int,
) -> Path:
    """Write a bag of an arm and a gripper.

    Args:
        path: Folder to write.
        plugin: How messages are stored.
        compression: How they are compressed; None if they are not.
        joints: Joints of the arm.
        count: Messages of the arm.
    """
    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    signals = np.random.default_rng(0).normal(size=(count, 3, len(joints)))
    writer = Writer(path, version=9, storage_plugin=plugin)
    if compression is not None:
        writer.set_compression(CompressionMode.STORAGE, compression)
    with writer as bag:
        arm, gripper = (
            bag.add_connection(topic, JOINT_STATE, typestore=store)
            for topic in ("/joint_states", "/gripper/joint_states")
        )
        for k in range(count):
            sec, nanosec = divmod(1_700_000_000_000_000_000 + k * 1_000_000, 10**9)
            header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](sec, nanosec), "base")
            message = types[JOINT_STATE](header, list(joints), *signals[k])
            bag.write(arm, sec * 10**9 + nanosec, store.serialize_cdr(message, JOINT_STATE))
            if k % GRIPPER_EVERY == 0:
                other = types[JOINT_STATE](header, ["finger"], *signals[k, :, :1])
                bag.write(gripper, sec * 10**9 + nanosec, store.serialize_cdr(other, JOINT_STATE))
    return path


if __name__ == "__main__":
    main()
