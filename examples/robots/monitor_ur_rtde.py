"""Watch an arm of Universal Robots over RTDE, beside whatever program moves it. It only reads, and commands nothing.

Usage:
    pip install ur_rtde
    python examples/robots/monitor_ur_rtde.py 192.168.1.10 --robot ur10 --gains gains.json --record healthy.csv
    cdia discover healthy.csv --robot ur10 --save model.json
    python examples/robots/monitor_ur_rtde.py 192.168.1.10 --robot ur10 --gains gains.json \
        --healthy healthy.csv --model model.json

The robot measures motor currents. gains.json turns them into torques: {"shoulder_pan_joint": N·m/A, ...}. Where the
gains are only known roughly, `cdia discover` finds by how much they are off. --record writes torques, so that
`cdia discover` needs no --gains.
"""

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from attached_arm import Tick, add_options, parsed, record_or_watch, taught

from cdia_pin import load_robot

POLL = 2e-4  # [s], wait for the next packet: an e-Series sends 500 a second, a CB3 125


def ticks(receive: Any, gains: np.ndarray) -> Iterator[Tick]:
    """Yield time [s], positions [rad], velocities [rad/s] and torques [N·m] of each packet of the robot.

    Args:
        receive: An RTDEReceiveInterface. Its joints go from base to wrist, as those of the URDF do.
        gains: Torque over current of each joint [N·m/A].
    """
    last = receive.getTimestamp()
    while receive.isConnected():
        t = receive.getTimestamp()  # of the robot's controller, free of the network's jitter
        if t == last:
            time.sleep(POLL)
            continue
        q, v, current = receive.getActualQ(), receive.getActualQd(), receive.getActualCurrent()
        if receive.getTimestamp() != t:
            continue  # the next packet came in between: read all of it
        last = t
        yield t, np.array(q), np.array(v), gains * np.array(current)


def main() -> None:
    """Read the command line; record, or learn and watch."""
    parser = argparse.ArgumentParser(description="Watch an arm over RTDE.")
    parser.add_argument("address", help="of the robot")
    parser.add_argument("--robot", required=True, help="name or URDF file")
    parser.add_argument("--gains", required=True, help="JSON file {joint: N·m/A}")
    add_options(parser)
    asked = parsed(parser)
    robot = load_robot(asked.robot)
    by_joint = json.loads(Path(asked.gains).read_text(encoding="utf-8"))
    gains = np.array([by_joint[joint] for joint in robot.joints])
    monitor = None if asked.record else taught(robot, asked.healthy, asked.model)

    from rtde_receive import RTDEReceiveInterface

    arm = ticks(RTDEReceiveInterface(asked.address), gains)
    record_or_watch(arm, robot, asked, monitor)


if __name__ == "__main__":
    main()
