"""One case with the monitor in the loop, and what came of it.

Single faults, pairs and triples are asked for 4 s after their detection; faults that join each other, and unknown
ones, at the end of the run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from benchmarks.online import baseline, metrics
from benchmarks.online.control import NominalControl
from benchmarks.online.outcome import JointOutcome, Outcome
from benchmarks.online.plant import OnlinePlant
from benchmarks.online.run import OnlineRun
from benchmarks.online.scenarios import BANK, CONDITIONS, FREQUENCY, FURTHER, USUAL, Case, healthy_hour
from benchmarks.plant.motion import Reference
from cdia_pin.diagnosis import Event, Monitor, MonitorSettings
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import State, Term
from cdia_pin.logs import Log

Array = NDArray[np.float64]

SEED = 1  # of the model error
LEARNED_FROM = 2  # healthy runs of a minute, on motions that are used for nothing else
SHAPES = {"position_ripple": f"frequency={FREQUENCY}", "stribeck_friction": "decay=8"}
EFFECTS = tuple(BANK)
ALL_EFFECTS = (*BANK, *FURTHER)
ASKED_AT_THE_END = ("unknown", "joining")
SEEN_FOR = 1.0  # [s], the least over which a recovered torque is measured


class Loop:
    """Nominal control with a monitor that watches and corrects it.

    Args:
        monitor: The monitor; it is reset.
        nominal: The control of the arm that the file describes.
    """

    def __init__(self, monitor: Monitor, nominal: NominalControl) -> None:
        self.monitor, self.nominal = monitor, nominal
        self.torque = np.zeros(monitor.model.robot.n)
        self.thresholds: list[Array] = []
        self.corrections: list[Array] = []
        monitor.reset()

    def __call__(self, t: float, q: Array, v: Array | None, reference: Reference) -> Array:
        """Return the torque to command [N·m or N], shape (n,)."""
        status = self.monitor.update(t, q, v, self.torque)
        self.thresholds.append(status.threshold)
        self.corrections.append(status.torque_correction)
        self.torque = self.monitor.correct(self.nominal(t, q, v, reference), reference.v)
        return self.torque


@dataclass(frozen=True)
class Bench:
    """An arm with its monitor and its plain observer, both taught by the same healthy runs.

    Attributes:
        plant: The arm.
        monitor: The monitor.
        plain: Thresholds of the plain observer [N·m or N], shape (n,); infinite where it has no velocities.
    """

    plant: OnlinePlant
    monitor: Monitor
    plain: Array


@lru_cache(maxsize=4)
def bench(
    robot: str,
    effects: tuple[str, ...] = EFFECTS,
    conditions: str = USUAL,
    settings: MonitorSettings | None = None,
    minutes: int = LEARNED_FROM,
) -> Bench:
    """Return an arm whose monitor has learned from healthy minutes; the same one each time."""
    sensors, drives = CONDITIONS[conditions]
    plant = OnlinePlant(robot, seed=SEED, sensors=sensors, drives=drives)
    runs = healthy_runs(plant, minutes)
    bank = [f"{e}: {SHAPES[e]}" if e in SHAPES else e for e in effects]
    monitor = Monitor(Dynamics(plant.robot), healthy=[log_of(r) for r in runs], bank=bank, settings=settings)
    plain = np.full(plant.robot.n, np.inf)
    if sensors.velocity_std is not None:
        plain = baseline.threshold(np.concatenate([baseline.residual(plant.robot, r) for r in runs]))
    return Bench(plant, monitor, plain)


def healthy_runs(plant: OnlinePlant, minutes: int = LEARNED_FROM) -> list[OnlineRun]:
    """Return the runs of a minute that monitors learn from."""
    cases = healthy_hour(plant.robot.name, 60 + minutes)[60:]
    return [case.run(plant, NominalControl(plant.robot)) for case in cases]


def log_of(run: OnlineRun) -> Log:
    """Return what the monitor saw of a run: with each sample the torque that acted since the one before."""
    effort = np.vstack([np.zeros_like(run.command[:1]), run.command[:-1]])
    return Log(run.joints, run.time, run.q_measured, effort, run.v_measured, source="healthy run")


def run_case(case: Case, settings: MonitorSettings | None = None, minutes: int = LEARNED_FROM) -> Outcome:
    """Run a case with the monitor in the loop; with faults also without it, and without them.

    Args:
        case: What happens.
        settings: Of the monitor; its own if omitted.
        minutes: Healthy ones that the monitor has learned from.
    """
    b = bench(case.robot, ALL_EFFECTS if _is_further(case) else EFFECTS, case.conditions, settings, minutes)
    nominal = NominalControl(b.plant.robot)
    loop = Loop(b.monitor, nominal)
    try:
        run = case.run(b.plant, loop)
    except FloatingPointError:
        return _ran_away(case, b, _left_alone(case, b.plant, nominal))
    events = b.monitor.events
    residual = None if run.v_measured is None else baseline.residual(b.plant.robot, run)
    healthy = case.run(b.plant, nominal, healthy=True) if case.faults else None
    alone = _left_alone(case, b.plant, nominal) if case.faults else None
    joints = tuple(
        _joint(joint, since, case, b, loop, run, residual, healthy, alone)
        for joint, since in _begun(case).items()
    )
    if case.suite == "arm":
        joints = (_arm(case, events),)
    drop = again = np.nan
    if case.suite == "return":
        first, second = case.faults
        drop = metrics.drop_delay(events, joints[0].joint, first.until, second.after)
        again = metrics.found_again_delay(run, events, joints[0].joint, second.after)
    return replace(
        _nothing_seen(case, b.monitor),
        false_alarms=len(metrics.false_alarms(run, events)),
        plain_false_alarms=_plain_false_alarms(case, b, run, residual),
        joints=joints,
        drop=drop,
        again=again,
    )


def _is_further(case: Case) -> bool:
    return any(f.effect in FURTHER for f in case.faults)


def _nothing_seen(case: Case, monitor: Monitor) -> Outcome:
    """Return a case and what the monitor said, with nothing measured yet."""
    return Outcome(
        id=case.id,
        suite="further" if _is_further(case) else case.suite,
        robot=case.robot,
        conditions=case.conditions,
        share=case.share,
        effects=tuple(dict.fromkeys(str(f) for f in case.faults)),
        minutes=case.duration / 60.0,
        false_alarms=0,
        plain_false_alarms=0,
        said=tuple(_in_words(e) for e in monitor.events if e.stage != "accommodation"),
    )


def _ran_away(case: Case, b: Bench, alone: OnlineRun | None) -> Outcome:
    """Return what came of an arm that its drives could not hold, in spite of the monitor."""
    joints = tuple(
        JointOutcome(
            joint=joint,
            detected=bool(np.isfinite(detected_at)),
            since_begin=detected_at - since,
            verdict="the arm ran away",
            tracking=np.inf,
            against_none=1.0 if alone is None else np.inf,
        )
        for joint, since in _begun(case).items()
        for detected_at in [metrics.detection_time(b.monitor.events, joint, since)]
    )
    if case.suite == "arm":
        joints = (replace(_arm(case, b.monitor.events), verdict="the arm ran away"),)
    return replace(_nothing_seen(case, b.monitor), joints=joints)


def _begun(case: Case) -> dict[str, float]:
    """Return when the first fault of each joint begins [s]."""
    out: dict[str, float] = {}
    for f in case.faults:
        if f.joint:
            out[f.joint] = min(f.after, out.get(f.joint, np.inf))
    return out


def _left_alone(case: Case, plant: OnlinePlant, nominal: NominalControl) -> OnlineRun | None:
    """Return the run of the arm that does not know of its faults; None if it runs away."""
    try:
        return case.run(plant, nominal)
    except FloatingPointError:
        return None


def _joint(
    joint: str,
    since: float,
    case: Case,
    b: Bench,
    loop: Loop,
    run: OnlineRun,
    residual: Array | None,
    healthy: OnlineRun | None,
    alone: OnlineRun | None,
) -> JointOutcome:
    j, events = run.joints.index(joint), b.monitor.events
    detected_at = metrics.detection_time(events, joint, since)
    at = run.time[-1] if case.suite in ASKED_AT_THE_END else detected_at + metrics.TIME_TO_DECIDE
    said = metrics.isolation(run, events, joint, at)
    isolated = min(
        (e.time for e in events if e.stage == "isolation" and joint in e.joints and e.time >= since),
        default=np.inf,
    )
    plain_at = np.nan
    if residual is not None:
        late = run.time >= since
        plain_at = baseline.detection_times(run.time[late], residual[late], b.plain)[j]
    tracking = against_none = recovered = learned = np.nan
    if healthy is not None:
        far = metrics.tracking_rms(run)[j]
        tracking = far / metrics.tracking_rms(healthy)[j]
        against_none = 0.0 if alone is None else far / metrics.tracking_rms(alone)[j]
    if isolated < run.time[-1] - SEEN_FOR:
        recovered = metrics.recovered_share(run, -np.array(loop.corrections), isolated)[j]
        learned = metrics.recovered_share(run, _torque_of(b.monitor.faults, b.plant, run), isolated)[j]
    return JointOutcome(
        joint=joint,
        detected=bool(np.isfinite(detected_at)),
        delay=metrics.detection_delay(run, events, np.array(loop.thresholds), joint, since),
        since_begin=detected_at - since,
        plain_delay=float(plain_at - metrics.onset(run, b.plain, joint, since)),
        plain_since_begin=float(plain_at - since),
        verdict=said.verdict,
        named=tuple("+".join(sorted(label.partition("@")[0] for label in one)) for one in said.named),
        right=said.right,
        unique=said.unique,
        holds=said.holds_truth,
        tracking=float(tracking),
        against_none=float(against_none),
        recovered=float(recovered),
        learned=float(learned),
        region=_region(events, b.monitor.faults, joint),
    )


def _arm(case: Case, events: Sequence[Event]) -> JointOutcome:
    """Return what was said of a fault of the whole arm; its joint is ``arm``."""
    (fault,) = case.faults
    since = fault.after
    detected_at = min((e.time for e in events if e.stage == "detection" and e.time >= since), default=np.nan)
    true = "external_wrench" if fault.effect == "tool_wrench" else fault.effect
    # A push is asked for while it lasts; the others some time after their detection.
    at = fault.until if true == "external_wrench" else detected_at + metrics.TIME_TO_DECIDE
    named = metrics.believed(events, at)
    of_joints = frozenset(n for n in named if n not in metrics.OF_THE_ARM)
    gone = metrics.cleared(events, true, fault.until) - fault.until
    return JointOutcome(
        joint="arm",
        detected=bool(np.isfinite(detected_at)),
        since_begin=detected_at - since,
        verdict="unique" if named else "none",
        named=("+".join(sorted(named)),),
        right=true in named,
        unique=named == {true},
        holds=true in named and not of_joints,
        region="" if np.isnan(gone) else f"gone after {gone:.3f} s",
        delay=gone,
    )


def _plain_false_alarms(case: Case, b: Bench, run: OnlineRun, residual: Array | None) -> int:
    if residual is None:
        return 0
    begin = np.full(len(run.joints), np.inf)
    for joint, since in _begun(case).items():
        begin[run.joints.index(joint)] = since
    seen = baseline.detection_times(run.time, residual, b.plain)
    return int((seen < begin).sum())


def _torque_of(terms: Sequence[Term], plant: OnlinePlant, run: OnlineRun) -> Array:
    """Return what terms say the faults' torque was along a run [N·m or N], shape (K, n)."""
    a = np.gradient(run.v, run.tick, axis=0)
    x = State.of(plant.robot, run.q, run.v, a, effort=run.command, time=run.time)
    return np.sum([term.torque(x) for term in terms], axis=0) if terms else np.zeros_like(run.q)


def _region(events: Sequence[Event], faults: Sequence[Term], joint: str) -> str:
    """Return the last region that was said of a fault of a joint, such as ``speed above 0.5``."""
    terms = [t for e in events for t in e.faults] + list(faults)
    regions = [t.profile for t in terms if t.effect.scope == (joint,) and t.profile.kind == "region"]
    if not regions:
        return ""
    numbers = regions[-1].to_dict()
    ends = [f"{w} {numbers[k]:.2f}" for k, w in (("lower", "above"), ("upper", "below")) if k in numbers]
    return f"{numbers['signal']} {' and '.join(ends)}"


def _in_words(e: Event) -> str:
    names = " + ".join(t.effect.name for t in e.faults)
    others = "".join(" or " + (" + ".join(t.effect.name for t in one)) for one in e.alternatives)
    said = f" {e.verdict}: {names}{others}" if e.stage == "isolation" else ""
    return f"{e.time:.2f} s {e.stage} {'+'.join(e.joints)}{said}"
