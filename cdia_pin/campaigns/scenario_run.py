"""One scenario in the closed loop, and what came of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from math import inf, nan
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from cdia_pin.campaigns.alarm_scores import AlarmScores, scores
from cdia_pin.campaigns.campaign_spec import Setting
from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopRun
from cdia_pin.campaigns.loop_comparison import onset
from cdia_pin.campaigns.monitored_control import Tick
from cdia_pin.campaigns.run_row import RunRow
from cdia_pin.campaigns.scenario import Batch, DrawnArm, Scenario
from cdia_pin.diagnosis import Event, Monitor, MonitorSettings
from cdia_pin.diagnosis.engines import settings_of
from cdia_pin.diagnosis.status import EventStage
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.dynamics.trajectories import Trajectory
from cdia_pin.effects import State, Term, parse_term
from cdia_pin.errors import CdiaError, EffectError, ModelError
from cdia_pin.phrases import one_line
from cdia_pin.robot import load_robot

Array = NDArray[np.float64]

MOTION = (
    0  # number of the motion of all runs of an arm; the healthy runs that its monitor learns from have others
)
SETTLED = 3.0  # [s], from the onset to the start of the comparison of tracking: time for the isolation
SIZING = 1000  # samples of the motion along which a fault is sized


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


def run_batch(batch: Batch) -> list[RunRow]:
    """Make all runs of an arm.

    Args:
        batch: The arm and its scenarios.

    Returns:
        A row for each; one that failed has its error.
    """
    rows = []
    for scenario in batch.scenarios:
        begin = perf_counter()
        try:
            row = run_scenario(batch.arm, scenario, batch.tracking)
        except CdiaError as error:
            row = replace(described(batch.arm, scenario), error=one_line(error))
        rows.append(replace(row, seconds=perf_counter() - begin))
    return rows


def run_scenario(arm: DrawnArm, scenario: Scenario, tracking: bool) -> RunRow:
    """Make a run.

    Args:
        arm: The arm.
        scenario: What happens.
        tracking: Whether tracking is compared with other runs.
    """
    made = watched(arm, scenario)
    faults, loop, events = made.faults, taught(arm).loop, made.events
    begin = onset(faults) if faults else inf
    faulty = made.faulty_joints or frozenset(loop.robot.joints)  # a fault of the whole arm is of every joint
    detections = [e for e in events if e.stage == EventStage.DETECTION]
    seen = [e.time for e in detections if e.time >= begin and faulty & set(e.joints)]
    true = frozenset(t.label for t in faults)
    row = replace(
        described(arm, scenario, faults),
        onset=begin if faults else nan,
        healthy_time=min(begin, scenario.duration),
        false_alarms=sum(e.time < begin for e in detections),
        elsewhere=sum(e.time >= begin and not faulty & set(e.joints) for e in detections),
        detected=bool(seen),
        delay=min(seen) - begin if seen else nan,
        named="+".join(sorted(made.believed)) or "nothing",
        exact=made.believed == true,
        holds=true in _explanations(events, faulty) or made.believed == true,
        diverged=made.run is None,
        peaks=made.scores.peaks,
        delays=made.scores.delays,
    )
    if not (tracking and faults):
        return row
    since = begin + SETTLED
    healthy = _tracking(loop, scenario, (), since)
    alone = _tracking(loop, scenario, faults, since)
    with_monitor = np.full(loop.robot.n, inf) if made.run is None else made.run.tracking(since)
    return replace(
        row, tracking=float(np.max(with_monitor / healthy)), tracking_alone=float(np.max(alone / healthy))
    )


@dataclass(frozen=True)
class WatchedRun:
    """A scenario under its monitor.

    Attributes:
        faults: What was hidden.
        run: The run; None if it diverged.
        events: Of the monitor.
        believed: Labels of the faults that are believed at the end.
        scores: What it says about thresholds.
    """

    faults: tuple[Term, ...]
    run: LoopRun | None
    events: tuple[Event, ...]
    believed: frozenset[str]
    scores: AlarmScores

    @property
    def faulty_joints(self) -> frozenset[str]:
        """Names of the joints that have a fault."""
        return joints_of(self.faults)


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

    run = _unless_diverged(lambda: loop.run(motion, faults, monitor, noise=scenario.noise, watch=watch))
    somewhere = joints_of(faults) or frozenset(loop.robot.joints)
    faulty = np.array([j in somewhere for j in loop.robot.joints])
    return WatchedRun(
        faults,
        run,
        monitor.events if run is None or run.monitored is None else run.monitored.events,
        frozenset(t.label for t in monitor.faults),
        scores(
            np.array(ratios),
            np.array(times),
            debounce_of(arm),
            onset(faults) if faults else inf,
            faulty,
        ),
    )


def hidden(loop: ClosedLoop, motion: Trajectory, scenario: Scenario) -> tuple[Term, ...]:
    """Return the faults of a scenario in their sizes.

    Args:
        loop: The arm.
        motion: The desired motion, along which they are sized.
        scenario: What happens.

    Raises:
        EffectError: If a fault is to be sized and has no torque along the motion.
    """
    robot = loop.model.robot
    terms = tuple(parse_term(text, robot) for text in scenario.faults)
    if scenario.share is None:
        return terms
    time = np.linspace(0.0, scenario.duration, SIZING)
    asked = motion(time)
    x = State.of(robot, asked.q, asked.v, asked.a, time=time)
    return tuple(sized(term, x, scenario.share) for term in terms)


def sized(term: Term, x: State, share: float) -> Term:
    """Return a term whose RMS torque is a share of that of its joints; its profile does not count.

    Args:
        term: The term; its parameters are all multiplied by the same number.
        x: A motion of the healthy arm.
        share: RMS torque of the term over that of its joints [1].

    Raises:
        EffectError: If it has no torque along the motion.
    """
    joints = [x.robot.joint_index(j) for j in term.effect.scope] or list(range(x.robot.n))
    torque = term.effect.torque(x, np.array(term.theta))[:, joints]
    size = float(np.sqrt(np.mean(torque**2)))
    if not size > 0:
        raise EffectError(f"{term.label} has no torque along the motion, so it cannot have a share of it")
    wanted = share * float(np.sqrt(np.mean(x.effort[:, joints] ** 2)))
    return term.with_theta(wanted / size * np.array(term.theta))


def described(arm: DrawnArm, scenario: Scenario, faults: Sequence[Term] = ()) -> RunRow:
    """Return the row of a run with nothing measured yet.

    Args:
        arm: The arm.
        scenario: What happens.
        faults: What is hidden, in its sizes.
    """
    return RunRow(
        number=scenario.number,
        robot=arm.robot,
        model_error=arm.loop.model_error,
        noise=arm.loop.noise,
        settings=settings_words(arm.settings),
        repeat=scenario.repeat,
        arm_seed=arm.loop.seed,
        fault="+".join(sorted(text.partition("@")[0].partition(":")[0].strip() for text in scenario.faults)),
        joint="+".join(dict.fromkeys(j for t in faults for j in t.effect.scope)),
        terms="; ".join(
            f"{t.label}: {', '.join(f'{name}={value:.4g}' for name, value in t.values.items())}"
            for t in faults
        ),
        share=nan if scenario.share is None else scenario.share,
        duration=scenario.duration,
    )


def settings_words(settings: Sequence[Setting]) -> str:
    """Return settings as text.

    Args:
        settings: Names and values.
    """
    return ", ".join(f"{name}={value}" for name, value in settings)


def debounce_of(arm: DrawnArm) -> int:
    """Return how many ticks in a row beyond the threshold make a detection.

    Args:
        arm: The arm.
    """
    settings = settings_of(arm.engine, **dict(arm.settings))
    return settings.debounce if isinstance(settings, MonitorSettings) else settings.confirm


def joints_of(faults: Sequence[Term]) -> frozenset[str]:
    """Return the joints on which faults act; empty for one of the whole arm.

    Args:
        faults: True faults.
    """
    return frozenset(j for t in faults for j in t.effect.scope)


def _explanations(events: Sequence[Event], joints: frozenset[str]) -> set[frozenset[str]]:
    """Return the sets of labels that the last isolation on some joints gave."""
    isolations = [e for e in events if e.stage == EventStage.ISOLATION and joints & set(e.joints)]
    return {frozenset(t.label for t in one) for e in isolations[-1:] for one in (e.faults, *e.alternatives)}


def _tracking(loop: ClosedLoop, scenario: Scenario, faults: Sequence[Term], since: float) -> Array:
    """Return the RMS tracking error of each joint without a monitor [rad or m], shape (n,); inf if it diverged."""
    motion = loop.motion(MOTION, scenario.duration)
    run = _unless_diverged(lambda: loop.run(motion, faults, noise=scenario.noise))
    return np.full(loop.robot.n, inf) if run is None else run.tracking(since)


def _unless_diverged(run: Callable[[], LoopRun]) -> LoopRun | None:
    try:
        return run()
    except ModelError:  # the simulation diverged
        return None
