"""Sources of the second page: a simulated arm with faults to switch, or a log as a monitor would have seen it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings
from cdia_pin.campaigns.monitored_control import Tick
from cdia_pin.diagnosis import Monitor, MonitorSettings
from cdia_pin.diagnosis.healthy_part import parted
from cdia_pin.diagnosis.monitor_record import what_is_blind
from cdia_pin.dynamics import Dynamics
from cdia_pin.dynamics.physical import require_physical
from cdia_pin.dynamics.trajectories import Repeated
from cdia_pin.effects import Term, parse_term
from cdia_pin.errors import EffectError
from cdia_pin.logs import Log, read_log
from cdia_pin.progress import Progress
from cdia_pin.robot import RobotModel, load_robot

Array = NDArray[np.float64]

RATE = 500.0  # [Hz], of the simulated control
MOTION = 40.0  # [s], after which the simulated motion begins again
POSES = 60  # that a picture is to hold


@dataclass(frozen=True, eq=False)
class Source:
    """A moving arm and its monitor.

    Attributes:
        robot: The arm.
        monitor: Its monitor.
        ticks: Samples, each with the monitor's status.
        reach: Positions on the way, from the first on, for a picture that holds them all [rad or m], shape (K, n).
        faults: Faults that can be switched on and off.
        acting: Faults that act now; whoever switches one changes this set.
        notes: What a reader should know besides, in sentences.
    """

    robot: RobotModel
    monitor: Monitor
    ticks: Iterator[Tick]
    reach: Array
    faults: tuple[Term, ...] = ()
    acting: set[Term] = field(default_factory=set)
    notes: tuple[str, ...] = ()


def simulated(robot: str, faults: Sequence[str], accommodate: bool, tell: Progress) -> Source:
    """Prepare an endless closed loop whose faults are switched by hand, none of them at first.

    Args:
        robot: Name of the catalogue, or path of a URDF.
        faults: Such as ``coulomb_friction@elbow_joint: level=5``; if empty, usual ones, sized to the arm.
        accommodate: Whether the monitor corrects the control.
        tell: Reports progress while the monitor learns from healthy runs.

    Raises:
        CdiaError: If there is no such robot, or a fault does not fit it.
    """
    tell("reading the robot", 0.0)
    loop = ClosedLoop(Dynamics(load_robot(robot)), LoopSettings(rate=RATE))
    terms = tuple(parse_term(text, loop.robot) for text in faults or usual_faults(loop))
    if len(set(terms)) < len(terms):
        raise EffectError("a fault is given twice")
    require_physical(terms, loop.robot)
    motion = Repeated(loop.motion(0, MOTION))
    monitor = loop.monitor(
        settings=MonitorSettings(accommodate=accommodate), progress=lambda s, x: tell(s, 0.1 + 0.85 * x)
    )
    acting: set[Term] = set()
    ticks = loop.ticks(motion, terms, monitor, acts=acting.__contains__)
    reach = motion(np.linspace(0.0, MOTION, POSES)).q
    blind = what_is_blind(monitor.record)
    return Source(loop.robot, monitor, ticks, reach, terms, acting, (blind,) if blind else ())


def usual_faults(loop: ClosedLoop) -> list[str]:
    """Return a fault on each of up to four joints, sized by the torque that the joint needs.

    Args:
        loop: The closed loop.
    """
    joints, slides = loop.robot.joints, loop.robot.is_prismatic
    motion = loop.motion(0, MOTION)(np.linspace(0.0, MOTION, 400))
    torque = np.sqrt(np.mean(loop.robot.inverse_dynamics(*motion) ** 2, axis=0))

    def size(j: int, share: float) -> str:
        return f"{max(share * torque[j], 0.05):.2g}"

    def viscous(j: int) -> str:
        return f"coefficient={size(j, 5.0 if slides[j] else 0.8)}"

    kinds: tuple[tuple[int, str, Callable[[int], str]], ...] = (
        (2, "coulomb_friction", lambda j: f"level={size(j, 0.4)}"),
        (1, "actuator_gain", lambda j: "gain=-0.25"),
        (3, "torque_offset", lambda j: f"offset={size(j, 0.4)}"),
        (0, "viscous_friction", viscous),
    )
    return [f"{name}@{joints[j]}: {sized(j)}" for j, name, sized in kinds if j < len(joints)]


def replayed(robot: str, path: Path, tell: Progress) -> Source:
    """Prepare a log as a monitor would have seen it live; its first part is taken as healthy.

    Args:
        robot: Name of the catalogue, or path of a URDF.
        path: The log.
        tell: Reports progress.

    Raises:
        CdiaError: If the log cannot be read, or is too short.
    """
    tell("reading the robot", 0.0)
    arm = load_robot(robot)
    tell("reading the log", 0.2)
    healthy, watched = parted(read_log(path, arm))
    tell("learning from the healthy part", 0.5)
    monitor = Monitor(Dynamics(arm), healthy=[healthy], position_only=watched.velocity is None)
    said = f"The first {healthy.duration:.3g} s are taken as healthy."
    blind = what_is_blind(monitor.record)
    notes = (said, blind) if blind else (said,)
    reach = watched.position[:: len(watched.time) // POSES + 1]
    return Source(arm, monitor, _ticks(monitor, watched), reach, notes=notes)


def _ticks(monitor: Monitor, log: Log) -> Iterator[Tick]:
    monitor.reset()
    for k in range(len(log.time)):
        t, q, tau = float(log.time[k]), log.position[k], log.effort[k]
        v = None if log.velocity is None else log.velocity[k]
        yield Tick(t, q, np.zeros_like(q) if v is None else v, tau, q, monitor.update(t, q, v, tau))
