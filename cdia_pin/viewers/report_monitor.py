"""The report of a monitor's run: residuals, stages, corrections, events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.viewers.event_words import event_rows, fault_words
from cdia_pin.viewers.page import write_page
from cdia_pin.viewers.report_faults import AgainstMotion, against_motion, motion_of, presence
from cdia_pin.viewers.report_isolation import (
    HypothesisRow,
    ParameterHistory,
    Span,
    hypotheses,
    parameters,
    stage_spans,
)
from cdia_pin.viewers.report_scene import scene_of_run
from cdia_pin.viewers.report_series import Numbers, compact, compact_one, extremes
from cdia_pin.viewers.stage_colours import STAGE_COLOURS, STAGE_WORDS
from cdia_pin.viewers.text_monitor import run_summary, share_words
from cdia_pin.viewers.whole_arm_row import WHOLE_ARM, of_joint, whole_arm_row
from cdia_pin.viewers.words import joint_units, short_names

if TYPE_CHECKING:
    from cdia_pin.diagnosis import MonitorRun
    from cdia_pin.effects import State, Term

Array = NDArray[np.float64]


class StageWords(TypedDict):
    """How the page shows a stage."""

    colour: str
    words: str


class MonitoredJoint(TypedDict):
    """What the page shows of a joint; ``usual`` is the median threshold.

    ``nearness`` is the largest residual over its threshold of that moment [1].
    ``share`` is the threshold's share of the RMS torque of healthy motion, in words.
    """

    name: str
    short: str
    units: dict[str, str]
    time: list[float]
    residual: Numbers
    threshold: Numbers
    effort: Numbers
    correction: Numbers
    error: Numbers | None
    stages: list[Span]
    present: list[Span]
    hypotheses: list[HypothesisRow]
    parameters: list[ParameterHistory]
    against: AgainstMotion | None
    usual: float | None
    share: str
    blind: bool
    nearness: float | None
    believed: list[str]


class MonitoredArm(TypedDict):
    """What the page shows of the whole arm: payload, tilt, contact."""

    name: str
    stage: str
    believed: list[str]


class TrackingDocument(TypedDict):
    """RMS of the tracking error by run, each (n,) [rad or m]."""

    since: float
    runs: dict[str, Numbers]


class MonitorReport(TypedDict):
    """What the page shows: the schema ``cdia-monitor-report/1``."""

    schema: str
    title: str
    command: str
    version: str
    robot: str
    summary: str
    engine: str
    begin: float
    end: float
    duration: float
    stages: dict[str, StageWords]
    events: list[dict[str, Any]]  # fields of `EventRow`
    joints: list[MonitoredJoint]
    arm: MonitoredArm | None
    tracking: TrackingDocument | None
    notes: list[str]
    record: dict[str, Any]


def write_monitor_report(
    path: str | Path,
    run: MonitorRun,
    *,
    tracking: Mapping[str, Array] | None = None,
    since: float = 0.0,
    present: Sequence[Term] = (),
    title: str = "",
    command: str = "",
) -> Path:
    """Write residuals, stages, events and corrections of a monitor's run as one HTML page.

    The page has at most 6 MB and needs no network.

    Args:
        path: Where to write; folders are made, an existing file is replaced.
        run: Of a replay or a closed loop.
        tracking: RMS of the tracking error of each joint [rad or m], shape (n,), by the name of the run.
        since: Start of the time over which they are compared [s].
        present: Faults that the plant has, where they are known, as in a simulation.
        title: Headline; made from the robot if empty.
        command: The command that made the report, to be shown.

    Returns:
        The path of the page.

    Raises:
        CdiaError: If the file cannot be written.
        MissingExtraError: If the extra ``view`` is not installed.
    """

    def data(points: int) -> MonitorReport:
        return monitor_data(
            run,
            tracking=tracking,
            since=since,
            present=present,
            title=title,
            command=command,
            points=points,
        )

    return write_page(path, data, scene_of_run(run), "monitor.js", (run_summary(run),))


def monitor_data(
    run: MonitorRun,
    *,
    tracking: Mapping[str, Array] | None = None,
    since: float = 0.0,
    present: Sequence[Term] = (),
    title: str = "",
    command: str = "",
    points: int = 2000,
) -> MonitorReport:
    """Collect what the page shows, ready for JSON.

    Args:
        run: Of a replay or a closed loop.
        tracking: RMS of the tracking error of each joint [rad or m], shape (n,), by the name of the run.
        since: Start of the time over which they are compared [s].
        present: Faults that the plant has, where they are known.
        title: Headline; made from the robot if empty.
        command: The command that made the report.
        points: Most samples of a curve.
    """
    x = motion_of(run)
    return {
        "schema": schemas.MONITOR_REPORT,
        "title": title or f"{run.robot.name}: monitored run",
        "command": command,
        "version": run.record["version"],
        "robot": run.robot.name,
        "summary": run_summary(run),
        "engine": run.record["engine"],
        "begin": round(float(run.time[0]), 4),
        "end": round(float(run.time[-1]), 4),
        "duration": round(run.duration, 4),
        "stages": {
            str(stage): {"colour": colour, "words": STAGE_WORDS[stage]}
            for stage, colour in STAGE_COLOURS.items()
        },
        "events": [asdict(row) for row in event_rows(run.events, run.robot)],
        "joints": [_joint(run, x, j, present, points) for j in range(run.robot.n)],
        "arm": _arm(run),
        "tracking": None
        if tracking is None
        else {"since": since, "runs": {name: compact(rms) for name, rms in tracking.items()}},
        "notes": run.record.get("notes", []),
        "record": {k: v for k, v in run.record.items() if k not in ("notes", "sight", "version")},
    }


def _arm(run: MonitorRun) -> MonitoredArm | None:
    row = whole_arm_row(run)
    if row is None:
        return None
    return {"name": WHOLE_ARM, "stage": str(row.stage), "believed": list(row.believed)}


def _joint(run: MonitorRun, x: State, j: int, present: Sequence[Term], points: int) -> MonitoredJoint:
    joint = run.joints[j]
    units = joint_units(run.robot, joint)
    error = None if run.desired is None else run.position[:, j] - run.desired[:, j]
    signals = [run.residual[:, j], run.effort[:, j]] + ([] if error is None else [error])
    keep = extremes(signals, points)
    keep = np.union1d(keep, np.flatnonzero(np.diff(run.stages[:, j], prepend=255)))
    limit = run.threshold[:, j]
    return {
        "name": joint,
        "short": short_names(run.joints)[joint],
        "units": {**units, "residual": units["load" if run.in_torque else "velocity"]},
        "time": [round(float(t), 4) for t in run.time[keep]],
        "residual": compact(run.residual[keep, j]),
        "threshold": compact(limit[keep]),
        "effort": compact(run.effort[keep, j]),
        "correction": compact(run.torque_correction[keep, j]),
        "error": None if error is None else compact(error[keep]),
        "stages": stage_spans(run, j),
        "present": presence(run, x, j, present),
        "hypotheses": hypotheses(run, j),
        "parameters": parameters(run, j, present),
        "against": against_motion(run, x, j, points),
        "usual": compact_one(float(run.typical_threshold[j])),
        "share": share_words(run.record["sight"].get(joint)),
        "blind": joint in run.blind,
        "nearness": compact_one(float(run.nearness[j])),
        "believed": [fault_words(t, run.robot) for t in of_joint(run.faults, joint)],
    }
