"""One scenario in the closed loop, and what came of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf, nan
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from cdia_pin.campaigns.closed_loop import ClosedLoop
from cdia_pin.campaigns.run_row import RunRow
from cdia_pin.campaigns.scenario import Batch, DrawnArm, Scenario
from cdia_pin.campaigns.watched_run import MOTION, taught, unless_diverged, watched
from cdia_pin.diagnosis import Event, MonitorSettings
from cdia_pin.diagnosis.engines import settings_of
from cdia_pin.diagnosis.status import EventStage
from cdia_pin.effects import Term
from cdia_pin.errors import CdiaError
from cdia_pin.phrases import one_line

Array = NDArray[np.float64]

SETTLED = 3.0  # [s], from the onset to the start of the comparison of tracking: time for the isolation


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
    begin, faulty, said = made.onset, made.faulty_joints, made.scores(debounce_of(arm))
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
        peaks=said.peaks,
        delays=said.delays,
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
        speed=arm.loop.speed,
        duration=scenario.duration,
    )


def settings_words(settings: Sequence[tuple[str, object]]) -> str:
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


def _explanations(events: Sequence[Event], joints: frozenset[str]) -> set[frozenset[str]]:
    """Return the sets of labels that the last isolation on some joints gave."""
    isolations = [e for e in events if e.stage == EventStage.ISOLATION and joints & set(e.joints)]
    return {frozenset(t.label for t in one) for e in isolations[-1:] for one in (e.faults, *e.alternatives)}


def _tracking(loop: ClosedLoop, scenario: Scenario, faults: Sequence[Term], since: float) -> Array:
    """Return the RMS tracking error of each joint without a monitor [rad or m], shape (n,); inf if it diverged."""
    motion = loop.motion(MOTION, scenario.duration)
    run = unless_diverged(lambda: loop.run(motion, faults, noise=scenario.noise))
    return np.full(loop.robot.n, inf) if run is None else run.tracking(since)
