"""How well a monitor did, from what happened (a run) and what it said (its events); pure functions.

Times that never come are NaN. A joint counts as faulty from the first tick at which a fault's torque acts on it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from benchmarks.online.events import Event, Named
from benchmarks.online.run import OnlineRun
from benchmarks.online.scenarios import same_torque

Array = NDArray[np.float64]

NOTHING = 1e-9  # share of the largest fault torque that is rounding
CONSTANT = 1e-6  # variance of a fault's torque over its mean square, below which it is a constant [1]
TIME_TO_DECIDE = 4.0  # [s] after the detection


# ---------------------------------------------------------------- detection


def faulty(run: OnlineRun) -> NDArray[np.bool_]:
    """Tell from which tick on a fault has acted on a joint, shape (K, n)."""
    size = np.abs(run.fault_torque)
    return np.maximum.accumulate(size > NOTHING * max(size.max(), 1e-12), axis=0)


def false_alarms(run: OnlineRun, events: Iterable[Event]) -> list[Event]:
    """Return the detections that name a joint on which no fault has acted so far."""
    acted = faulty(run)
    return [
        e
        for e in events
        if e.stage == "detection"
        and any(not acted[_row(run, e.time), run.joints.index(joint)] for joint in e.joints)
    ]


def onset(run: OnlineRun, thresholds: ArrayLike, joint: str, since: float = -np.inf) -> float:
    """Return when a fault's own torque first exceeds the threshold [s]: from then on it could be seen.

    Args:
        run: What happened.
        thresholds: Of the residual [N·m or N], shape (n,) or (K, n).
        joint: Which one.
        since: Time from which on it is looked for [s].
    """
    j = run.joints.index(joint)
    limit = np.broadcast_to(np.asarray(thresholds, float), run.fault_torque.shape)[:, j]
    return _first(run.time, (np.abs(run.fault_torque[:, j]) > limit) & (run.time >= since))


def detection_time(events: Iterable[Event], joint: str, since: float = -np.inf) -> float:
    """Return the first detection on a joint from a time on [s]."""
    return min((e.time for e in events if _is(e, "detection", joint) and e.time >= since), default=np.nan)


def detection_delay(
    run: OnlineRun, events: Iterable[Event], thresholds: ArrayLike, joint: str, since: float = 0.0
) -> float:
    """Return the time from the onset to the detection on a joint [s].

    NaN if either never came. It is negative where a fault was seen below the threshold.

    Args:
        run: What happened.
        events: What was said.
        thresholds: Of the residual [N·m or N], shape (n,) or (K, n).
        joint: Which one.
        since: When the fault begins [s].
    """
    return detection_time(events, joint, since) - onset(run, thresholds, joint, since)


# ---------------------------------------------------------------- isolation


@dataclass(frozen=True)
class Isolation:
    """What a monitor believed of a joint at one time.

    Attributes:
        verdict: The last one; ``none`` if there was none.
        right: Whether the faults named are the true ones and no others.
        unique: Whether they are right and the only ones named.
        holds_truth: Whether the true ones are among those named, in first or in another place.
        named: The sets of labels, the likeliest first.
        time: When it said so [s].
    """

    verdict: str
    right: bool
    unique: bool
    holds_truth: bool
    named: tuple[frozenset[str], ...]
    time: float


def isolation(
    run: OnlineRun,
    events: Iterable[Event],
    joint: str,
    at: float,
    truths: Sequence[frozenset[str]] | None = None,
) -> Isolation:
    """Return what was believed of a joint at a time, beside what was true then.

    Only the faults on this joint count: an event may speak of several joints.

    Args:
        run: What happened.
        events: What was said.
        joint: Which joint.
        at: When [s]; usually 4 s after the detection.
        truths: Sets of labels that are right; by default the faults present then, or the same torque.
    """
    truths = true_labels(run, joint, at) if truths is None else truths
    said = [
        e
        for e in events
        if joint in e.joints and e.time <= at and (e.stage in {"isolation", "idle"} or _corrects(e))
    ]
    if not said:
        return Isolation("none", False, False, False, (), np.nan)
    last = max(said, key=lambda e: e.time)  # of several at one time the first; they agree
    if last.stage == "idle":
        return Isolation("none", not any(truths), not any(truths), not any(truths), (), last.time)
    named = tuple(dict.fromkeys(_labels(one, joint) for one in (last.faults, *last.alternatives)))
    verdict = str(last.verdict)
    if verdict == "unknown" or not named[0]:
        return Isolation(verdict, False, False, False, named, last.time)
    right = named[0] in truths
    alone = verdict == "unique" and len(named) == 1
    return Isolation(verdict, right, right and alone, any(n in truths for n in named), named, last.time)


OF_THE_ARM = ("payload", "base_tilt", "external_wrench")  # effects of the whole arm that a monitor names


def believed(events: Iterable[Event], at: float) -> frozenset[str]:
    """Return the names of the effects that were believed in at a time, of the whole arm and of joints.

    Args:
        events: What was said.
        at: When [s].
    """
    of_joint: dict[str, frozenset[str]] = {}
    of_arm: set[str] = set()
    for e in events:
        if e.time > at or e.stage not in {"isolation", "idle"}:
            continue
        names = {t.label.partition("@")[0] for t in e.faults}
        if names & set(OF_THE_ARM):
            # What is found in place of a contact ends it.
            of_arm = of_arm - names if e.stage == "idle" else (of_arm - {"external_wrench"}) | names
        elif len(e.joints) == 1:
            of_joint[e.joints[0]] = frozenset() if e.stage == "idle" else frozenset(names)
    return frozenset(of_arm).union(*of_joint.values())


def cleared(events: Iterable[Event], effect: str, since: float) -> float:
    """Return when an effect was said to be gone, at or after a time [s]; NaN if never.

    Args:
        events: What was said.
        effect: Name of the effect.
        since: When it has vanished [s].
    """
    said = (
        e.time
        for e in events
        if e.stage == "idle" and e.time >= since and effect in {t.label.partition("@")[0] for t in e.faults}
    )
    return min(said, default=np.nan)


def isolation_after_detection(
    run: OnlineRun, events: Sequence[Event], joint: str, within: float = TIME_TO_DECIDE, since: float = 0.0
) -> Isolation:
    """Return what was believed of a joint some time [s] after the first detection on it since a time [s]."""
    return isolation(run, events, joint, detection_time(events, joint, since) + within)


def true_labels(run: OnlineRun, joint: str, at: float) -> tuple[frozenset[str], ...]:
    """Return the sets of labels that are true of a joint at a time [s], the plainest first."""
    effects = [f.effect for f in run.faults if f.joint == joint and f.share(at) > 0]
    return tuple(frozenset(f"{e}@{joint}" for e in one) for one in same_torque(effects))


# ---------------------------------------------------------------- accommodation


def tracking_rms(run: OnlineRun, last: float = 3.0) -> Array:
    """Return the RMS distance from the reference over the last seconds [rad or m], shape (n,)."""
    late = run.time > run.time[-1] - last
    return np.sqrt(np.mean((run.q - run.reference.q)[late] ** 2, axis=0))


@dataclass(frozen=True)
class Tracking:
    """How far an accommodated arm stays from its reference, beside the two that bound it, shape (n,) each.

    Attributes:
        accommodated: With the faults and the monitor's correction [rad or m, RMS].
        healthy: Without faults, the same motion and noise.
        unaccommodated: With the faults, and nothing done about them.
    """

    accommodated: Array
    healthy: Array
    unaccommodated: Array

    @property
    def against_healthy(self) -> Array:
        """How many times as far as a healthy arm [1]; 1 is as good as can be."""
        return self.accommodated / self.healthy

    @property
    def improvement(self) -> Array:
        """How many times nearer than without accommodation [1]."""
        return self.unaccommodated / self.accommodated


def tracking(
    accommodated: OnlineRun, healthy: OnlineRun, unaccommodated: OnlineRun | None, last: float = 3.0
) -> Tracking:
    """Compare three runs of the same motion over their last seconds; None stands for one that diverged."""
    held, well = tracking_rms(accommodated, last), tracking_rms(healthy, last)
    fallen = np.full_like(held, np.inf)
    return Tracking(held, well, fallen if unaccommodated is None else tracking_rms(unaccommodated, last))


def recovered_share(run: OnlineRun, estimate: Array, since: float, until: float = np.inf) -> Array:
    """Return 1 − mean (f − f̂)² / var f of the faults' torque between two times [1], shape (n,).

    NaN where the faults' torque is constant or absent; below zero where the estimate is worse than a constant.

    Args:
        run: What happened.
        estimate: f̂ [N·m or N], shape (K, n).
        since: First time that counts [s].
        until: Time from which on it no longer counts [s].
    """
    rows = (run.time >= since) & (run.time < until)
    f = run.fault_torque[rows]
    missed = np.mean((f - np.asarray(estimate, float)[rows]) ** 2, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(f.var(axis=0) > CONSTANT * np.mean(f**2, axis=0), 1 - missed / f.var(axis=0), np.nan)


# ---------------------------------------------------------------- vanishing and returning


def drop_delay(events: Iterable[Event], joint: str, vanished: float, back: float = np.inf) -> float:
    """Return how long after it vanished [s] a fault of a joint was no longer believed in; NaN if it still was.

    Args:
        events: What was said.
        joint: Which joint.
        vanished: When the fault vanished [s].
        back: When it returned; a drop after that does not count [s].
    """
    drops = (e for e in events if joint in e.joints and vanished <= e.time < back and _is_drop(e))
    return min((e.time for e in drops), default=np.nan) - vanished


def found_again_delay(run: OnlineRun, events: Iterable[Event], joint: str, back: float) -> float:
    """Return how long after its return [s] the true faults of a joint were named first; NaN if they never were."""
    truths = true_labels(run, joint, back)
    named = (
        e.time
        for e in events
        if joint in e.joints
        and e.time >= back
        and e.stage in {"isolation", "accommodation"}
        and _labels(e.faults, joint) in truths
    )
    return min(named, default=np.nan) - back


# ---------------------------------------------------------------- parts


def _corrects(event: Event) -> bool:
    """Whether an event corrects for a fault; one without a verdict is of bad samples, and says nothing of faults."""
    return event.stage == "accommodation" and str(event.verdict) != "none"


def _is(event: Event, stage: str, joint: str) -> bool:
    return event.stage == stage and joint in event.joints


def _is_drop(event: Event) -> bool:
    return event.stage == "idle" or (event.stage == "isolation" and str(event.verdict) == "none")


def _labels(terms: Sequence[Named], joint: str) -> frozenset[str]:
    """Return the labels that are about a joint."""
    return frozenset(t.label for t in terms if joint in t.label.partition("@")[2].split("+"))


def _row(run: OnlineRun, time: float) -> int:
    return int(np.clip(np.searchsorted(run.time, time + 1e-9, side="right") - 1, 0, len(run.time) - 1))


def _first(time: Array, true: NDArray[np.bool_]) -> float:
    return float(time[np.argmax(true)]) if true.any() else float("nan")
