"""Watch an arm of Universal Robots over RTDE, beside whatever program moves it. It only reads, and commands nothing.

Usage:
    pip install ur_rtde
    python examples/monitor_ur_rtde.py 192.168.1.10 --robot ur10 --gains gains.json --record healthy.csv
    cdia discover healthy.csv --robot ur10 --save model.json
    python examples/monitor_ur_rtde.py 192.168.1.10 --robot ur10 --gains gains.json \
        --healthy healthy.csv --model model.json

The robot measures motor currents. gains.json turns them into torques: {"shoulder_pan_joint": N·m/A, ...}. Where the
gains are only known roughly, `cdia discover` finds by how much they are off. --record writes torques, so that
`cdia discover` needs no --gains.
"""

import argparse
import contextlib
import json
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from cdia_pin import Dynamics, Log, Monitor, RobotModel, load_model, load_robot, read_log, write_log

POLL = 2e-4  # [s], wait for the next packet: an e-Series sends 500 a second, a CB3 125

Tick = tuple[float, np.ndarray, np.ndarray, np.ndarray]


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


def record(arm: Iterator[Tick], robot: RobotModel, path: str, seconds: float) -> None:
    """Write some seconds of ticks as a log."""
    kept = [next(arm)]
    while kept[-1][0] - kept[0][0] < seconds:
        kept.append(next(arm))
    t, q, v, tau = (np.array(signal) for signal in zip(*kept, strict=True))
    write_log(Log(robot.joints, t, q, tau, velocity=v), path)


def watch(arm: Iterable[Tick], monitor: Monitor, say: Callable[[str], None] = print) -> None:
    """Feed ticks to a monitor, and say what it finds."""
    for t, q, v, tau in arm:
        for event in monitor.update(t, q, v, tau).events:
            faults = ", ".join(f"{term.label} {term.values}" for term in event.faults)
            joints = ", ".join(event.joints)
            say(
                f"{event.time:.3f} s  {event.stage} on {joints}: {event.verdict} {faults} {event.reason}".strip()
            )


def main() -> None:
    """Read the command line; record, or learn and watch."""
    parser = argparse.ArgumentParser(description="Watch an arm over RTDE.")
    parser.add_argument("address", help="of the robot")
    parser.add_argument("--robot", required=True, help="name or URDF file")
    parser.add_argument("--gains", required=True, help="JSON file {joint: N·m/A}")
    parser.add_argument("--record", help="write a log of the healthy arm, instead of watching")
    parser.add_argument("--seconds", type=float, default=120.0, help="length of that log")
    parser.add_argument("--healthy", help="log of the healthy arm")
    parser.add_argument("--model", help="model.json of cdia discover; the URDF alone if omitted")
    asked = parser.parse_args()
    if not (asked.record or asked.healthy):
        parser.error("give --record, or --healthy")
    robot = load_robot(asked.robot)
    by_joint = json.loads(Path(asked.gains).read_text(encoding="utf-8"))
    gains = np.array([by_joint[joint] for joint in robot.joints])
    monitor = None
    if not asked.record:
        model = load_model(asked.model, robot) if asked.model else Dynamics(robot)
        monitor = Monitor(model, healthy=[read_log(asked.healthy, robot)])
        print(*monitor.record["notes"], sep="\n")

    from rtde_receive import RTDEReceiveInterface

    arm = ticks(RTDEReceiveInterface(asked.address), gains)
    if monitor is None:
        record(arm, robot, asked.record, asked.seconds)
    else:
        with contextlib.suppress(KeyboardInterrupt):
            watch(arm, monitor)


if __name__ == "__main__":
    main()
