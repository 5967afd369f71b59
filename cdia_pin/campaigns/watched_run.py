"""A scenario under its monitor: what it said, and by how much residuals exceeded thresholds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import inf

import numpy as np
from numpy.typing import NDArray

from cdia_pin.campaigns.alarm_scores import AlarmScores, scores
from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopRun
from cdia_pin.campaigns.loop_comparison import onset
from cdia_pin.campaigns.monitored_control import Tick
from cdia_pin.campaigns.scenario import DrawnArm, Scenario
from cdia_pin.campaigns.scenario_faults import hidden
from cdia_pin.diagnosis import Event, Monitor
from cdia_pin.diagnosis.engines import settings_of
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.errors import ModelError
from cdia_pin.robot import load_robot

Array = NDArray[np.float64]

MOTION = (
    0  # number of the motion of all runs of an arm; the healthy runs that its monitor learns from have others
)


@dataclass(frozen=True)
class TaughtArm:
    """An arm with its monitor.

    Attributes:
        loop: Plant, control and sensors.
        monitor: Has learned from the arm's healthy runs.
    """

    loop: ClosedLoop
    monitor: Monitor


@lru_cache(maxsize=2)
def taught(arm: DrawnArm) -> TaughtArm:
    """Return an arm whose monitor has learned.

    Args:
        arm: The arm.
    """
    loop = ClosedLoop(Dynamics(load_robot(arm.robot)), arm.loop)
    settings = settings_of(arm.engine, **dict(arm.settings))
    return TaughtArm(loop, loop.monitor(bank=arm.bank, engine=arm.engine, settings=settings))


@dataclass(frozen=True, eq=False)
class WatchedRun:
    """A scenario under its monitor.

    Attributes:
        faults: What was hidden.
        run: The run; None if it diverged.
        events: Of the monitor.
        believed: Labels of the faults that are believed at the end.
        joints: Names of the arm's joints.
        time: Time of the ticks [s], shape (K,).
        ratio: |residual| over threshold at each tick [1], shape (K, n).
    """

    faults: tuple[Term, ...]
    run: LoopRun | None
    events: tuple[Event, ...]
    believed: frozenset[str]
    joints: tuple[str, ...]
    time: Array
    ratio: Array

    def __repr__(self) -> str:
        return f"WatchedRun({len(self.time)} ticks, {len(self.faults)} faults, {len(self.events)} events)"

    @property
    def faulty_joints(self) -> frozenset[str]:
        """Names of the joints that have a fault; all joints of the arm if it is one of the whole arm."""
        return frozenset(j for t in self.faults for j in t.effect.scope) or frozenset(self.joints)

    @property
    def onset(self) -> float:
        """When the first fault begins [s]; infinite without one."""
        return onset(self.faults) if self.faults else inf

    def scores(self, debounce: int) -> AlarmScores:
        """Return what the run says about thresholds.

        Args:
            debounce: Ticks in a row that make a detection.
        """
        faulty = np.array([j in self.faulty_joints for j in self.joints])
        return scores(self.ratio, self.time, debounce, self.onset, faulty)


def watched(arm: DrawnArm, scenario: Scenario) -> WatchedRun:
    """Run a scenario under its monitor.

    Args:
        arm: The arm.
        scenario: What happens.

    Raises:
        CdiaError: If the fault has no size, or the arm cannot make the motion.
    """
    loop, monitor = taught(arm).loop, taught(arm).monitor
    motion = loop.motion(MOTION, scenario.duration)
    faults = hidden(loop, motion, scenario)
    times: list[float] = []
    ratios: list[Array] = []

    def watch(tick: Tick) -> None:
        if tick.status is not None:
            times.append(tick.time)
            size, threshold = np.abs(tick.status.residual), tick.status.threshold
            ratios.append(np.divide(size, threshold, out=np.zeros_like(size), where=threshold > 0))

    run = unless_diverged(lambda: loop.run(motion, faults, monitor, noise=scenario.noise, watch=watch))
    return WatchedRun(
        faults,
        run,
        monitor.events if run is None or run.monitored is None else run.monitored.events,
        frozenset(t.label for t in monitor.faults),
        loop.robot.joints,
        np.array(times),
        np.array(ratios),
    )


def unless_diverged(run: Callable[[], LoopRun]) -> LoopRun | None:
    """Return a run; None if its simulation diverged.

    Args:
        run: Makes it.
    """
    try:
        return run()
    except ModelError:  # the simulation diverged
        return None
