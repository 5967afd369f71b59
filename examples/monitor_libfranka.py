"""Watch a Franka arm. It only reads states, and commands nothing.

Usage:
    python examples/monitor_libfranka.py --robot panda --udp 5005 --record healthy.csv
    cdia discover healthy.csv --robot panda --torque-side link --save model.json
    python examples/monitor_libfranka.py --robot panda --udp 5005 --healthy healthy.csv --model model.json

A loop that moves the arm through libfranka is C++, at 1 kHz, and libfranka reads no states beside it while such a
loop runs. So the loop itself sends its states to this process, which may be late without harm:

    // in the callback of robot.control, which must not wait: a UDP socket, connected to 127.0.0.1:5005
    double sent[22] = {state.time.toSec()};
    std::copy(state.q.begin(), state.q.end(), sent + 1);
    std::copy(state.dq.begin(), state.dq.end(), sent + 8);
    std::copy(state.tau_J.begin(), state.tau_J.end(), sent + 15);
    send(udp, sent, sizeof sent, MSG_DONTWAIT);

With --address instead of --udp, states are read through pylibfranka (pip install pylibfranka), while no loop of
libfranka moves the arm. That is good for a first look, not for a healthy run: a hand that guides pushes. A Python
program that moves the arm through panda_py calls `watch(ticks(panda.get_state), monitor)` in a thread of its own.

tau_J is measured behind the gear. A payload, a push or a tilted base show in it. Friction of motor and gear do not.
"""

import argparse
import contextlib
import socket
import struct
import time
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np

from cdia_pin import Dynamics, Log, Monitor, RobotModel, load_model, load_robot, read_log, write_log

POLL = 1e-4  # [s], wait for the next state; there are 1000 a second
PACKET = struct.Struct("=22d")  # time, q, dq, tau_J

Tick = tuple[float, np.ndarray, np.ndarray, np.ndarray]


def ticks(read: Callable[[], Any]) -> Iterator[Tick]:
    """Yield time [s], positions [rad], velocities [rad/s] and torques [N·m] of each new state.

    Args:
        read: Returns a RobotState of libfranka: `Robot.read_once` of pylibfranka, `Panda.get_state` of panda_py.
    """
    last = None
    while True:
        state = read()
        t = state.time.to_sec()
        if t == last:
            time.sleep(POLL)
            continue
        last = t
        yield t, np.array(state.q), np.array(state.dq), np.array(state.tau_J)


def ticks_from_udp(receiver: socket.socket) -> Iterator[Tick]:
    """Yield the same of each packet that a C++ loop sends."""
    while True:
        t, *signals = PACKET.unpack(receiver.recv(PACKET.size))
        q, v, tau = np.array(signals).reshape(3, 7)
        yield t, q, v, tau


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
    parser = argparse.ArgumentParser(description="Watch a Franka arm.")
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("--udp", type=int, help="port to which a C++ loop sends states")
    source.add_argument("--address", help="of the robot, read through pylibfranka")
    parser.add_argument("--robot", default="panda", help="name or URDF file")
    parser.add_argument("--record", help="write a log of the healthy arm, instead of watching")
    parser.add_argument("--seconds", type=float, default=120.0, help="length of that log")
    parser.add_argument("--healthy", help="log of the healthy arm")
    parser.add_argument("--model", help="model.json of cdia discover; the URDF alone if omitted")
    asked = parser.parse_args()
    if not (asked.record or asked.healthy):
        parser.error("give --record, or --healthy")
    robot = load_robot(asked.robot)
    monitor = None
    if not asked.record:
        model = load_model(asked.model, robot) if asked.model else Dynamics(robot)
        monitor = Monitor(model, healthy=[read_log(asked.healthy, robot)])
        print(*monitor.record["notes"], sep="\n")
    if asked.udp:
        receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        receiver.bind(("127.0.0.1", asked.udp))
        arm = ticks_from_udp(receiver)
    else:
        from pylibfranka import RealtimeConfig, Robot

        # Reading alone needs no realtime kernel.
        arm = ticks(Robot(asked.address, RealtimeConfig.kIgnore).read_once)
    if monitor is None:
        record(arm, robot, asked.record, asked.seconds)
    else:
        with contextlib.suppress(KeyboardInterrupt):
            watch(arm, monitor)


if __name__ == "__main__":
    main()
