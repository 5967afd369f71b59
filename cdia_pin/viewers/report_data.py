"""Everything that a report shows, as one document; results are read here, nothing is estimated."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypedDict

import numpy as np

from cdia_pin import schemas
from cdia_pin.errors import CdiaError
from cdia_pin.viewers.report_changes import ChangesDocument, LogErrors, changes_data, log_errors
from cdia_pin.viewers.report_discovery import DiscoveryDocument, discovery_data
from cdia_pin.viewers.report_series import (
    SIGNALS,
    Against,
    Cloud,
    OverTime,
    against,
    cloud,
    compact_one,
    end_to_end,
    over_time,
)
from cdia_pin.viewers.words import joint_units, region_words, short_names

if TYPE_CHECKING:
    from cdia_pin.changes import Changes
    from cdia_pin.discovery import Comparison, Discovery
    from cdia_pin.logs import LogCheck
    from cdia_pin.logs.motion import MotionRecord
    from cdia_pin.robot.model import RobotModel

REGIONS = 12  # worst regions listed for a model


class ErrorsDocument(TypedDict):
    """Errors of a model on a joint; RMS and bias in its torque unit."""

    rms: float | None
    bias: float | None
    autocorrelation: float | None


class JointReport(TypedDict):
    """What a report shows of a joint."""

    name: str
    short: str
    units: dict[str, str]
    torque_rms: float | None
    before: ErrorsDocument
    after: ErrorsDocument | None
    heldout_torque_rms: float | None
    heldout: float | None
    floor: float | None
    structure_left: bool
    rests: bool
    time: OverTime
    cloud: Cloud
    against: dict[str, Against]


class RegionRow(TypedDict):
    """A region in which the residual is large."""

    joint: str
    where: str
    ratio: float | None
    bias: float | None


class RegionsDocument(TypedDict):
    """Worst regions of both models."""

    before: list[RegionRow]
    after: list[RegionRow] | None


class FindingRow(TypedDict):
    """A finding of `check_log`."""

    topic: str
    severity: str
    joint: str | None
    message: str
    advice: str


class CheckDocument(TypedDict):
    """What `check_log` says about a log."""

    source: str
    problems: int
    findings: list[FindingRow]


class ReportDocument(TypedDict):
    """What a report shows: the schema ``cdia-report/1``."""

    schema: str
    title: str
    command: str
    version: str
    robot: str
    given: list[str]
    logs: list[MotionRecord]  # as the record has them
    holdout: list[MotionRecord]
    duration: float
    samples: int
    joints: list[JointReport]
    discovery: DiscoveryDocument | None
    changes: list[ChangesDocument]
    by_log: list[LogErrors]
    regions: RegionsDocument
    checks: list[CheckDocument]


def report_data(
    comparison: Comparison,
    improved: Comparison | None = None,
    discovery: Discovery | None = None,
    checks: Sequence[LogCheck] = (),
    *,
    changes: Sequence[Changes] = (),
    by_log: Sequence[Comparison] = (),
    title: str = "",
    command: str = "",
    points: int = 2000,
) -> ReportDocument:
    """Collect what a report shows.

    Args:
        comparison: The model as given against the logs.
        improved: The improved model against the same logs.
        discovery: How one became the other.
        checks: What was inferred about the logs.
        changes: What changed from the first log to the others.
        by_log: The model as given against each of several logs.
        title: Headline; made from the robot if empty.
        command: The command that made the report.
        points: Most samples of a curve or cloud.

    Returns:
        Schema ``cdia-report/1``, ready for JSON.
    """
    robot = comparison.model.robot
    time, _ = end_to_end(comparison)
    return {
        "schema": schemas.REPORT,
        "title": title or _title(robot, discovery, changes),
        "command": command,
        "version": comparison.record["version"],
        "robot": robot.name,
        "given": [t.label for t in comparison.model.terms],
        "logs": comparison.record["logs"],
        "holdout": discovery.record.get("holdout", []) if discovery else [],
        "duration": float(f"{time[-1] - time[0]:.5g}"),
        "samples": len(time),
        "joints": [joint_data(j, comparison, improved, discovery, points) for j in range(robot.n)],
        "discovery": discovery_data(discovery) if discovery else None,
        "changes": [changes_data(c) for c in changes],
        "by_log": log_errors(by_log),
        "regions": {"before": _regions(comparison), "after": _regions(improved) if improved else None},
        "checks": [_check(c) for c in checks],
    }


def _title(robot: RobotModel, discovery: Discovery | None, changes: Sequence[Changes]) -> str:
    if changes:
        return f"{robot.name}: what changed, and where the model fails"
    return f"{robot.name}: where the model fails" + (", and what it lacks" if discovery else "")


def require_same(comparison: Comparison, improved: Comparison | None, discovery: Discovery | None) -> None:
    """Check that results belong to one robot and to the same logs.

    Args:
        comparison: The model as given against the logs.
        improved: The improved model; None without one.
        discovery: How one became the other; None without one.

    Raises:
        CdiaError: If they do not.
    """
    joints = comparison.model.robot.joints
    for other in (improved, discovery):
        if other is not None and other.model.robot.joints != joints:
            given = ", ".join(other.model.robot.joints)
            raise CdiaError(f"a report is of one robot; these are of {', '.join(joints)} and of {given}")
    if improved is not None and not np.array_equal(improved.time, comparison.time):
        raise CdiaError("a report compares models on the same logs, filtered alike; these comparisons differ")


def _check(check: LogCheck) -> CheckDocument:
    return {
        "source": check.source,
        "problems": len(check.problems),
        "findings": [
            {
                "topic": f.topic,
                "severity": f.severity,
                "joint": f.joint,
                "message": f.message,
                "advice": f.advice,
            }
            for f in check.findings
        ],
    }


# ------------------------------------------------------------------ joints


def joint_data(
    j: int, before: Comparison, after: Comparison | None, found: Discovery | None, points: int
) -> JointReport:
    """Return what a report shows of one joint.

    Args:
        j: Index of the joint.
        before: The model as given against the logs.
        after: The improved model; None without one.
        found: How one became the other; None without one.
        points: Most samples of a curve or cloud.
    """
    robot = before.model.robot
    joint = robot.joints[j]
    return {
        "name": joint,
        "short": short_names(robot.joints)[joint],
        "units": joint_units(robot, joint),
        "torque_rms": compact_one(before.torque_rms[j]),
        "before": _errors(before, j),
        "after": None if after is None else _errors(after, j),
        "heldout_torque_rms": None if found is None else compact_one(found.heldout_torque_rms[j]),
        "heldout": None if found is None else compact_one(found.trace[-1].heldout_rms[j]),
        "floor": None if found is None else compact_one(found.noise_floor[j]),
        "structure_left": found is not None and joint in found.structure_left,
        "rests": found is not None and not bool(found.counted[j]),
        "time": over_time(before, after, j, points),
        "cloud": cloud(before, after, j, points),
        "against": {s: against(s, before, after, joint, j) for s in SIGNALS},
    }


def _errors(comparison: Comparison, j: int) -> ErrorsDocument:
    return {
        "rms": compact_one(comparison.rms[j]),
        "bias": compact_one(comparison.bias[j]),
        "autocorrelation": compact_one(comparison.autocorrelation[j]),
    }


def _regions(comparison: Comparison) -> list[RegionRow]:
    return [
        {
            "joint": r.joint,
            "where": region_words(r),
            "ratio": compact_one(r.ratio),
            "bias": compact_one(r.bias),
        }
        for r in comparison.worst_regions[:REGIONS]
    ]
