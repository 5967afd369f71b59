"""What the programs that read a robot share: a log of the healthy arm, a monitor from it, and what it says.

`monitor_*.py` say where the signals come from; this is the rest. It is no program of its own.
"""

import argparse
import contextlib
from collections.abc import Callable, Iterable, Iterator, Mapping

import numpy as np

from cdia_pin import Dynamics, Event, Log, Monitor, RobotModel, load_model, read_log, write_log

Tick = tuple[float, np.ndarray, np.ndarray, np.ndarray]  # time [s], positions, velocities, torques, SI


def record(arm: Iterator[Tick], robot: RobotModel, path: str, seconds: float) -> None:
    """Write some seconds of ticks as a log."""
    kept = [next(arm)]
    while kept[-1][0] - kept[0][0] < seconds:
        kept.append(next(arm))
    t, q, v, tau = (np.array(signal) for signal in zip(*kept, strict=True))
    write_log(Log(robot.joints, t, q, tau, velocity=v), path)


def sentence(event: Event) -> str:
    """Return an event in words."""
    faults = ", ".join(f"{term.label} {term.values}" for term in event.faults)
    said = f"{event.stage} on {', '.join(event.joints)}: {event.verdict}"
    return said + (f", {faults}" if faults else "") + (f" ({event.reason})" if event.reason else "")


def watch(arm: Iterable[Tick], monitor: Monitor, say: Callable[[str], None] = print) -> None:
    """Feed ticks to a monitor, and say what it finds."""
    for t, q, v, tau in arm:
        for event in monitor.update(t, q, v, tau).events:
            say(f"{event.time:.3f} s  {sentence(event)}")


def taught(
    robot: RobotModel, healthy: str, model: str | None, gains: Mapping[str, float] | None = None
) -> Monitor:
    """Return a monitor that has learned from a healthy log, and say what it learned.

    Args:
        robot: The arm.
        healthy: File of the log.
        model: File of a model; the URDF alone if omitted.
        gains: Torque over effort of each joint, {joint: N·m/A}, if the log has currents.
    """
    known = load_model(model, robot) if model else Dynamics(robot)
    monitor = Monitor(known, healthy=[read_log(healthy, robot, gains=gains)])
    print(*monitor.record["notes"], sep="\n")
    return monitor


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add what every such program asks for."""
    parser.add_argument("--record", help="write a log of the healthy arm, instead of watching")
    parser.add_argument("--seconds", type=float, default=120.0, help="length of that log")
    parser.add_argument("--healthy", help="log of the healthy arm")
    parser.add_argument("--model", help="model.json of cdia discover; the URDF alone if omitted")


def parsed(parser: argparse.ArgumentParser) -> argparse.Namespace:
    """Return the command line; it ends the program unless it says what to do."""
    asked = parser.parse_args()
    if not (asked.record or asked.healthy):
        parser.error("give --record, or --healthy")
    return asked


def record_or_watch(
    arm: Iterator[Tick], robot: RobotModel, asked: argparse.Namespace, monitor: Monitor | None
) -> None:
    """Record ticks, or feed them to a monitor until it is interrupted."""
    if monitor is None:
        record(arm, robot, asked.record, asked.seconds)
        return
    with contextlib.suppress(KeyboardInterrupt):
        watch(arm, monitor)
