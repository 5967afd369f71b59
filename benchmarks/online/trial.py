"""One case with the monitor in the loop, and what came of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from benchmarks.online import baseline, metrics
from benchmarks.online.control import NominalControl
from benchmarks.online.plant import OnlinePlant
from benchmarks.online.run import OnlineRun
from benchmarks.online.scenarios import BANK, BEGIN, FREQUENCY, FURTHER, Case, healthy_hour
from benchmarks.plant.motion import Reference
from cdia_pin import Dynamics
from cdia_pin.diagnosis import Monitor, MonitorSettings, Status
from cdia_pin.logs import Log

Array = NDArray[np.float64]

SEED = 1  # of the model error
LEARNED_FROM = 2  # healthy runs of a minute, on motions that are used for nothing else
SHAPES = {"position_ripple": f"frequency={FREQUENCY}", "stribeck_friction": "decay=8"}
EFFECTS = tuple(BANK)
ALL_EFFECTS = (*BANK, *FURTHER)


class Loop:
    """Nominal control with a monitor that watches and corrects it.

    Args:
        monitor: The monitor; it is reset.
        nominal: The control of the arm that the file describes.
    """

    def __init__(self, monitor: Monitor, nominal: NominalControl) -> None:
        self.monitor, self.nominal = monitor, nominal
        self.torque = np.zeros(monitor.model.robot.n)
        self.statuses: list[Status] = []
        self._most = monitor.model.robot.limits.effort
        monitor.reset()

    def __call__(self, t: float, q: Array, v: Array | None, reference: Reference) -> Array:
        """Return the torque to command [N·m or N], shape (n,)."""
        self.statuses.append(self.monitor.update(t, q, v, self.torque))
        self.torque = self.monitor.correct(self.nominal(t, q, v, reference), reference.v)
        return self.torque


@dataclass(frozen=True)
class Bench:
    """An arm with its monitor and its plain observer, both taught by the same healthy runs.

    Attributes:
        plant: The arm.
        monitor: The monitor.
        plain: Thresholds of the plain momentum observer [N·m or N], shape (n,).
        healthy: The runs they learned from.
    """

    plant: OnlinePlant
    monitor: Monitor
    plain: Array
    healthy: tuple[OnlineRun, ...]


@lru_cache(maxsize=4)
def bench(robot: str, effects: tuple[str, ...] = EFFECTS, settings: MonitorSettings | None = None) -> Bench:
    """Return an arm whose monitor has learned from healthy runs; the same one each time."""
    plant = OnlinePlant(robot, seed=SEED)
    runs = tuple(
        case.run(plant, NominalControl(plant.robot)) for case in healthy_hour(robot, 60 + LEARNED_FROM)[60:]
    )
    bank = [f"{e}: {SHAPES[e]}" if e in SHAPES else e for e in effects]
    monitor = Monitor(Dynamics(plant.robot), healthy=[log_of(r) for r in runs], bank=bank, settings=settings)
    residuals = [baseline.residual(plant.robot, r) for r in runs]
    return Bench(plant, monitor, baseline.threshold(np.concatenate(residuals)), runs)


def log_of(run: OnlineRun) -> Log:
    """Return what the monitor saw of a run: with each sample the torque that acted since the one before."""
    effort = np.vstack([np.zeros_like(run.command[:1]), run.command[:-1]])
    return Log(run.joints, run.time, run.q_measured, effort, run.v_measured, source="healthy run")


@dataclass(frozen=True)
class Outcome:
    """What came of a case, joint by joint where a fault is; NaN for what does not apply.

    Attributes:
        case: The case.
        false_alarms: Detections on joints that had no fault yet.
        detected: Whether each faulty joint was detected.
        delay: From when the fault's torque exceeded the threshold, for each faulty joint [s].
        right: Whether the right combination was named first, 4 s after detection.
        unique: Whether it was the only one.
        holds: Whether it was among those named.
        verdict: The verdict of each faulty joint then.
        ratio: Tracking error over that of the healthy arm, of each faulty joint [1].
        worse: Tracking error over that without accommodation [1].
        recovered: Share of the fault torque's variance that was recovered [1].
        baseline_delay: The plain observer's delay [s]; NaN where it saw nothing.
        baseline_false: The plain observer's false alarms.
        events: What was said, in words.
    """

    case: Case
    false_alarms: int
    detected: list[bool]
    delay: list[float]
    right: list[bool]
    unique: list[bool]
    holds: list[bool]
    verdict: list[str]
    ratio: list[float]
    worse: list[float]
    recovered: list[float]
    drop: float
    again: float
    baseline_delay: list[float]
    baseline_false: int
    events: list[str]


def run_case(
    case: Case, effects: tuple[str, ...] = EFFECTS, settings: MonitorSettings | None = None
) -> Outcome:
    """Run a case with the monitor in the loop, without it, and healthy."""
    b = bench(case.robot, effects, settings)
    nominal = NominalControl(b.plant.robot)
    loop = Loop(b.monitor, nominal)
    run = case.run(b.plant, loop)
    events = b.monitor.events
    thresholds = np.array([s.threshold for s in loop.statuses])
    estimate = -np.array([s.torque_correction for s in loop.statuses])
    joints = list(dict.fromkeys(f.joint for f in case.faults if f.joint))
    plain = nothing = None
    if case.faults:
        nothing = case.run(b.plant, nominal, healthy=True)
        try:
            plain = case.run(b.plant, nominal)
        except FloatingPointError:  # without accommodation the arm runs away
            plain = None
    out = Outcome(
        case, len(metrics.false_alarms(run, events)), *([] for _ in range(9)), np.nan, np.nan, [], 0, []
    )  # type: ignore[arg-type]
    observed = plain if plain is not None else run
    seen = baseline.detection_times(observed.time, baseline.residual(b.plant.robot, observed), b.plain)
    baseline_false = 0
    for j, joint in enumerate(b.plant.joints):
        when = seen[j]
        begin = min((f.after for f in case.faults if f.joint == joint), default=np.inf)
        baseline_false += bool(when < begin)
    for joint in joints:
        j = run.joints.index(joint)
        since = min(f.after for f in case.faults if f.joint == joint)
        when = metrics.detection_time(events, joint, since)
        out.detected.append(bool(np.isfinite(when)))
        out.delay.append(metrics.detection_delay(run, events, thresholds, joint, since))
        if case.suite == "unknown":
            said = metrics.isolation(run, events, joint, run.time[-1])
        else:
            said = metrics.isolation_after_detection(run, events, joint, since=since)
        out.right.append(said.right)
        out.unique.append(said.unique)
        out.holds.append(said.holds_truth)
        out.verdict.append(said.verdict)
        if nothing is not None:
            far = metrics.tracking_rms(run)[j]
            out.ratio.append(float(far / metrics.tracking_rms(nothing)[j]))
            out.worse.append(float(far / metrics.tracking_rms(plain)[j]) if plain is not None else 0.0)
        isolated = [e.time for e in events if e.stage == "isolation" and joint in e.joints]
        begin = max(isolated[0] if isolated else np.inf, since)
        recovered = np.nan
        if begin < run.time[-1] - 1.0:
            recovered = float(metrics.recovered_share(run, estimate, begin)[j])
        out.recovered.append(recovered)
        out.baseline_delay.append(seen[j] - metrics.onset(observed, b.plain, joint, since))
    drop = again = np.nan
    if case.suite == "return":
        first, second = case.faults
        drop = metrics.drop_delay(events, joints[0], first.until, second.after)
        again = metrics.found_again_delay(run, events, joints[0], second.after)
    words = [
        f"{e.time:.3f} {e.stage} {'+'.join(e.joints)} {e.verdict} "
        f"{', '.join(t.effect.name for t in e.faults)} {[[t.effect.name for t in a] for a in e.alternatives] or ''}"
        for e in events
        if e.stage != "accommodation"
    ]
    return replace(out, drop=drop, again=again, baseline_false=baseline_false, events=words)


__all__ = ["ALL_EFFECTS", "BEGIN", "EFFECTS", "Bench", "Loop", "Outcome", "bench", "log_of", "run_case"]
