"""What a campaign measured: a line for each combination, thresholds against alarms, names, and the worst runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import inf, isnan, nan
from typing import Any

import numpy as np

from cdia_pin import schemas
from cdia_pin.campaigns.alarm_scores import FACTORS, alarms
from cdia_pin.campaigns.campaign_spec import CampaignSpec
from cdia_pin.campaigns.estimates import Estimate, median, quantile, rate, share
from cdia_pin.campaigns.run_row import RunRow
from cdia_pin.phrases import counted, shortened
from cdia_pin.version import __version__

HOUR = 3600.0  # [s]
LATE = 0.9  # [1], share of the detections that come before the delay called late
WORST = 10  # runs that are listed
HEALTHY = "healthy"


@dataclass(frozen=True)
class Cell:
    """What came of the runs of one combination.

    Attributes:
        robot: Name of the robot.
        model_error: Largest relative error of the model's inertias [1].
        noise: Noise of the measured torques over their RMS [1].
        speed: Largest speed of the motion over the limit of the joint [1].
        settings: Settings of the engine that differ from the defaults.
        fault: Names of the hidden effects; ``healthy`` without any.
        share: Size of each fault as a share of its joint's torque [1]; NaN where it is as written.
        runs: Number of runs that were made.
        failed: Number of runs that could not be made.
        hours: Time without a fault [h].
        false_alarms: Alarms in that time [1/h].
        detected: Share of the faults that were detected [1].
        delay: Median time from onset to detection [s]; infinite where fewer than half were detected.
        late: Delay that 90 % of the runs stay below [s].
        exact: Share of the runs at whose end the hidden faults and no others were believed [1].
        tracking: Median RMS tracking error of the worst joint over that of the healthy arm [1].
        tracking_alone: The same without a monitor [1].
    """

    robot: str
    model_error: float
    noise: float
    speed: float
    settings: str
    fault: str
    share: float
    runs: int
    failed: int
    hours: float
    false_alarms: Estimate
    detected: Estimate
    delay: Estimate
    late: float
    exact: Estimate
    tracking: Estimate
    tracking_alone: Estimate

    def __repr__(self) -> str:
        return f"Cell({self.robot}, {shortened(self.fault)}, {self.runs} runs)"

    def to_dict(self) -> dict[str, Any]:
        """Return the cell for JSON."""
        return {k: v.to_dict() if isinstance(v, Estimate) else v for k, v in vars(self).items()}


@dataclass(frozen=True)
class OperatingPoint:
    """What the threshold detector would do with another threshold; the detector of lasting faults has no part in it.

    Attributes:
        factor: Threshold over that of the monitor [1].
        false_alarms: Alarms in the time without a fault [1/h].
        detected: Share of the faults whose residual crosses it by the end of the run [1].
    """

    factor: float
    false_alarms: Estimate
    detected: Estimate

    def to_dict(self) -> dict[str, Any]:
        """Return the point for JSON."""
        return {
            "factor": self.factor,
            "false_alarms_per_hour": self.false_alarms.to_dict(),
            "detected": self.detected.to_dict(),
        }


@dataclass(frozen=True)
class CampaignResult:
    """Result of a campaign.

    Attributes:
        spec: The plan.
        runs: Number of runs that were made.
        planned: Number of runs in the plan.
        whole: All runs of each settings of the engine, as one cell; its fault is ``all``.
        cells: A cell for each combination.
        operating_points: Of each settings of the engine, from low thresholds to high ones.
        names: Number of runs by hidden effects and by what was believed at the end.
        worst: The worst runs, the worst first, each with a reason.
    """

    spec: CampaignSpec
    runs: int
    planned: int
    whole: tuple[Cell, ...]
    cells: tuple[Cell, ...]
    operating_points: dict[str, tuple[OperatingPoint, ...]]
    names: dict[str, dict[str, int]]
    worst: tuple[tuple[RunRow, str], ...]

    def __repr__(self) -> str:
        return f"CampaignResult({self.runs} of {self.planned} runs, {len(self.cells)} combinations)"

    def to_dict(self) -> dict[str, Any]:
        """Return the result as ``cdia campaign --json`` writes it."""
        from dataclasses import asdict

        return {
            "schema": schemas.CAMPAIGN,
            "spec": asdict(self.spec),
            "runs": self.runs,
            "planned": self.planned,
            "whole": [c.to_dict() for c in self.whole],
            "cells": [c.to_dict() for c in self.cells],
            "operating_points": {k: [p.to_dict() for p in v] for k, v in self.operating_points.items()},
            "names": self.names,
            "worst": [{"why": why, **_short(row)} for row, why in self.worst],
            "record": {"version": __version__, "campaign": self.spec.digest},
        }


def summarised(spec: CampaignSpec, rows: Iterable[RunRow], planned: int) -> CampaignResult:
    """Return what a campaign measured.

    Args:
        spec: The plan.
        rows: The runs that were made.
        planned: Number of runs in the plan.
    """
    every = list(rows)
    by_settings = _grouped(every, lambda r: r.settings)
    names: dict[str, Counter[str]] = {}
    for row in every:
        if not row.error:
            names.setdefault(row.fault or HEALTHY, Counter())[_names(row.named)] += 1
    return CampaignResult(
        spec,
        len(every),
        planned,
        tuple(_cell(group, "all", nan) for group in by_settings.values()),
        tuple(_cell(g, g[0].fault or HEALTHY, g[0].share) for g in _grouped(every, _combination).values()),
        {settings: operating_points(group) for settings, group in by_settings.items()},
        {fault: dict(c.most_common()) for fault, c in names.items()},
        tuple((row, why) for row in sorted(every, key=_badness, reverse=True)[:WORST] if (why := _why(row))),
    )


def operating_points(rows: Sequence[RunRow]) -> tuple[OperatingPoint, ...]:
    """Return false alarms and detections over the threshold, from what each run's residual exceeded.

    Args:
        rows: Runs with the same settings.
    """
    made = [r for r in rows if not r.error]
    hours = sum(len(r.peaks) for r in made) / HOUR
    delays = np.array([r.delays for r in made if r.fault and r.delays]).reshape(-1, len(FACTORS))
    seen = np.isfinite(delays).sum(axis=0)
    return tuple(
        OperatingPoint(
            factor,
            rate(sum(alarms(np.array(r.peaks), factor) for r in made), hours),
            share(int(seen[k]), len(delays)),
        )
        for k, factor in enumerate(FACTORS)
    )


def _cell(rows: Sequence[RunRow], fault: str, size: float) -> Cell:
    first, made = rows[0], [r for r in rows if not r.error]
    faulty, arms = [r for r in made if r.fault], [(r.robot, r.arm_seed) for r in made if r.fault]
    hours = sum(r.healthy_time for r in made) / HOUR
    delays = [r.delay if r.detected else inf for r in faulty]
    return Cell(
        robot=first.robot if len({r.robot for r in rows}) == 1 else "all",
        model_error=_common(r.model_error for r in rows),
        noise=_common(r.noise for r in rows),
        speed=_common(r.speed for r in rows),
        settings=first.settings,
        fault=fault,
        share=size,
        runs=len(made),
        failed=len(rows) - len(made),
        hours=hours,
        false_alarms=rate(sum(r.false_alarms for r in made), hours),
        detected=share(sum(r.detected for r in faulty), len(faulty)),
        delay=median(delays, arms),
        late=quantile(delays, LATE),
        exact=share(sum(r.exact for r in faulty), len(faulty)),
        tracking=median([r.tracking for r in faulty], arms),
        tracking_alone=median([r.tracking_alone for r in faulty], arms),
    )


def _common(values: Iterable[float]) -> float:
    """Return the value that all runs have; NaN if they differ."""
    first, *others = set(values)
    return nan if others else first


def _combination(row: RunRow) -> tuple[object, ...]:
    size = -1.0 if isnan(row.share) else row.share
    return (row.settings, row.robot, row.model_error, row.noise, row.speed, row.fault, size)


def _grouped(rows: Iterable[RunRow], key: Callable[[RunRow], Any]) -> dict[Any, list[RunRow]]:
    out: dict[Any, list[RunRow]] = {}
    for row in rows:
        out.setdefault(key(row), []).append(row)
    return dict(sorted(out.items(), key=lambda pair: pair[0]))


def _names(labels: str) -> str:
    """Return the names of labels without their joints."""
    return "+".join(sorted(label.partition("@")[0] for label in labels.split("+")))


def _badness(row: RunRow) -> tuple[float, ...]:
    """Order runs: not made, ran away, false alarms, missed, wrongly named, then late."""
    missed, wrong = bool(row.fault) and not row.detected, bool(row.fault) and not row.exact
    late = 0.0 if isnan(row.delay) else row.delay
    return (bool(row.error), row.diverged, row.false_alarms, missed, wrong, row.elsewhere, late, -row.number)


def _why(row: RunRow) -> str:
    """Return in words what is wrong with a run; empty if nothing is."""
    said = []
    if row.error:
        return f"could not be made: {row.error}"
    if row.diverged:
        said.append("the arm ran away")
    if row.false_alarms:
        said.append(counted(row.false_alarms, "false alarm"))
    if row.fault and not row.detected:
        said.append("not detected")
    elif row.fault and not row.exact:
        said.append(f"named {row.named.replace('+', ' + ')}")
    if row.elsewhere:
        said.append(f"{counted(row.elsewhere, 'alarm')} on other joints")
    return ", ".join(said)


def _short(row: RunRow) -> dict[str, Any]:
    """Return a run without its lists."""
    return {k: v for k, v in vars(row).items() if k not in {"peaks", "delays"}}
