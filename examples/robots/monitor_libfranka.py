"""Watch a Franka arm. It only reads states, and commands nothing.

Usage:
    python examples/robots/monitor_libfranka.py --robot panda --udp 5005 --record healthy.csv
    cdia discover healthy.csv --robot panda --torque-side link --save model.json
    python examples/robots/monitor_libfranka.py --robot panda --udp 5005 --healthy healthy.csv --model model.json

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
import socket
import struct
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from attached_arm import Tick, add_options, parsed, record_or_watch, taught

from cdia_pin import load_robot

POLL = 1e-4  # [s], wait for the next state; there are 1000 a second
PACKET = struct.Struct("=22d")  # time, q, dq, tau_J


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


def main() -> None:
    """Read the command line; record, or learn and watch."""
    parser = argparse.ArgumentParser(description="Watch a Franka arm.")
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("--udp", type=int, help="port to which a C++ loop sends states")
    source.add_argument("--address", help="of the robot, read through pylibfranka")
    parser.add_argument("--robot", default="panda", help="name or URDF file")
    add_options(parser)
    asked = parsed(parser)
    robot = load_robot(asked.robot)
    monitor = None if asked.record else taught(robot, asked.healthy, asked.model)
    if asked.udp:
        receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        receiver.bind(("127.0.0.1", asked.udp))
        arm = ticks_from_udp(receiver)
    else:
        from pylibfranka import RealtimeConfig, Robot

        # Reading alone needs no realtime kernel.
        arm = ticks(Robot(asked.address, RealtimeConfig.kIgnore).read_once)
    record_or_watch(arm, robot, asked, monitor)


if __name__ == "__main__":
    main()
