"""A monitor's run in the terminal: its events, and the faults at the end."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from rich.table import Table
from rich.text import Text

from cdia_pin.changes.changes_result import ChangesVerdict
from cdia_pin.changes.confidence import Confidence
from cdia_pin.diagnosis.record import STAGES
from cdia_pin.diagnosis.status import LASTS, Stage
from cdia_pin.phrases import NO_BREAK
from cdia_pin.viewers.cells import add_row, clean, new_table
from cdia_pin.viewers.change_words import change_words
from cdia_pin.viewers.effect_groups import MOST_RIVALS, rivals
from cdia_pin.viewers.event_words import EventRow, event_rows, fault_words
from cdia_pin.viewers.whole_arm_row import WHOLE_ARM, of_joint, whole_arm_row
from cdia_pin.viewers.words import (
    confusion_words,
    joint_units,
    listed,
    number,
    percent,
    short_names,
    with_unit,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from cdia_pin.changes import Change
    from cdia_pin.diagnosis import Event, MonitorRun
    from cdia_pin.diagnosis.sight import JointSight
    from cdia_pin.robot.model import RobotModel

NEARNESS = "largest residual over its threshold"  # head of a column: a share of the threshold of that moment
MOST_PERCENT = 10.0  # share [1] up to which it is written in percent
STYLES = {"detection": "yellow", "isolation": "cyan", "idle": "green"}


def events_table(run: MonitorRun) -> Table:
    """Return the events of a monitor in their order.

    Args:
        run: Of a replay or a closed loop.
    """
    table = new_table("time", "joint", "stage", "said", left=(1, 2, 3))
    for row in event_rows(run.events, run.robot):
        stage = Text(row.stage, STYLES.get(row.stage.partition(",")[0], ""))
        table.add_row(clean(f"{row.time:.3f} s"), clean(row.joints), stage, _said(row))
    return table


def joints_table(run: MonitorRun) -> Table:
    """Return typical threshold, its share of the healthy torque, largest residual, last stage and faults of each joint.

    A threshold depends on the state, so the largest residual is a share of its threshold of that moment. The last row
    is that of the whole arm: payload, tilt, contact.

    Args:
        run: Of a replay or a closed loop.
    """
    heads = ("joint", "typical threshold", f"of{NO_BREAK}torque", NEARNESS, "at the end", "fault")
    table = new_table(*heads, left=(0, 4, 5))
    short = short_names(run.joints)
    sight = run.record["sight"]
    typical, nearness = run.typical_threshold.tolist(), run.nearness.tolist()
    for j, joint in enumerate(run.joints):
        unit = joint_units(run.robot, joint)["load" if run.in_torque else "velocity"]
        believed = [fault_words(t, run.robot) for t in of_joint(run.faults, joint)]
        add_row(
            table,
            short[joint],
            with_unit(number(typical[j]), unit),
            share_words(sight.get(joint)),
            percent(nearness[j]),
            stage_words(STAGES[run.stages[-1, j]], joint in run.blind),
            "\n".join(believed) or "–",
        )
    if (arm := whole_arm_row(run)) is not None:
        add_row(table, WHOLE_ARM, "–", "–", "–", str(arm.stage), "\n".join(arm.believed) or "–")
    return table


def share_words(sight: JointSight | None) -> str:
    """Return a threshold's share of the RMS torque of healthy motion, as ``12 %``, or ``1382 ×``.

    Args:
        sight: What is known of the joint, if anything.
    """
    share = None if sight is None else sight["share"]
    if share is None:
        return "–"
    return percent(share) if share <= MOST_PERCENT else f"{number(share)}{NO_BREAK}×"


def stage_words(stage: str, blind: bool) -> str:
    """Return a joint's stage, with the word ``blind`` where a fault could go unseen.

    Args:
        stage: The stage.
        blind: Whether the joint is blind.
    """
    return f"{stage}, blind" if blind else str(stage)


def tracking_table(robot: RobotModel, tracking: Mapping[str, NDArray[np.float64]], since: float) -> Table:
    """Return the RMS of position less desired position of several runs of a motion.

    Args:
        robot: The arm.
        tracking: RMS of each joint [rad or m], shape (n,), by the name of the run: healthy, faulty, accommodated.
        since: From when on they are compared [s].
    """
    corrected = "accommodated" in tracking
    ratio = ("over healthy",) if corrected else ()
    table = new_table("tracking error RMS", *tracking, *ratio, left=(0,))
    short = short_names(robot.joints)
    for j, joint in enumerate(robot.joints):
        unit = "mm" if robot.is_prismatic[j] else "mrad"
        cells = [_milli(rms[j], unit) for rms in tracking.values()]
        if corrected:
            cells.append(f"{tracking['accommodated'][j] / tracking['healthy'][j]:.2f} ×")
        add_row(table, short[joint], *cells)
    table.caption = f"from {since:g} s on, when the first fault begins" if since > 0 else "over the whole run"
    return table


def _milli(value: float, unit: str) -> str:
    return with_unit(number(1e3 * value), unit) if np.isfinite(value) else "diverged"


def run_summary(run: MonitorRun) -> str:
    """Return what happened in a run, in a few sentences.

    Args:
        run: Of a replay or a closed loop.
    """
    if not run.duration:
        return "Nothing was looked at: no sample is later than what the monitor has seen."
    span = f"{run.duration:.4g} s"
    everywhere = len(run.blind) == len(run.joints)
    blind = f" Blind: {'all joints' if everywhere else listed(run.blind)}." if run.blind else ""
    detections = [e for e in run.events if e.stage == "detection"]
    tolerated = _tolerated(run, _joints_of(run.events))
    lasting = _lasting(run)
    if not detections and run.faults:  # known from the log before
        return f"Nothing new was detected in {span}. {_at_the_end(run)}{blind}{lasting}"
    if not detections:
        return f"No fault was detected in {span}.{tolerated or _nearest(run)}{blind}{lasting}"
    left = [e for e in detections if e.reason != LASTS]
    lasted = [e for e in detections if e.reason == LASTS]
    seen = [
        f"{what} on {listed(_joints_of(events))}, first at {events[0].time:.3f} s"
        for what, events in (("the residual left its threshold", left), ("a small residual lasted", lasted))
        if events
    ]
    doubted = [j for j in _joints_of(detections) if j in run.blind]
    doubt = f" Doubt the detection on {listed(doubted)}: the monitor is blind there." if doubted else ""
    return f"In {span} {' and '.join(seen)}.{doubt} {_at_the_end(run)}{tolerated}{blind}{lasting}"


def _lasting(run: MonitorRun) -> str:
    """Return what differs between the healthy runs and the last part of a replay."""
    if run.lasting is None:
        return _not_compared(run.not_compared) if run.not_compared else ""
    changes, span = run.lasting.changes, f"{run.lasting.begin:.4g} to {run.lasting.end:.4g} s"
    if changes.verdict is ChangesVerdict.NOT_COMPARABLE:
        return _not_compared("no joint moves alike in both")
    said, shown = "Established", run.lasting.established
    if not shown and run.faults:  # what is likely supports what is believed, or contradicts it
        said, shown = "Likely changed", changes.changes
    if not shown:
        return "" if run.faults else f" No change since the healthy runs is established ({span})."
    found = listed(
        " or ".join(
            [
                change_words(c, changes),
                *map(confusion_words, rivals(c.term.effect, c.confusions)[:MOST_RIVALS]),
            ]
        )
        for c in shown
    )
    return f" {said} since the healthy runs ({span}): {found}.{_other_than_believed(run, shown)}"


def _other_than_believed(run: MonitorRun, shown: Sequence[Change]) -> str:
    """Return which name to trust where what is believed at the end has another one; empty where it has not."""
    names = {c.term.label for c in shown} | {e.label for c in shown for x in c.confusions for e in x.effects}
    if not run.faults or names & {t.label for t in run.faults}:
        return ""
    if all(c.confidence is Confidence.ESTABLISHED for c in shown):
        return " This name is surer than that at the end, which is from less data."
    return " The two names differ: neither is sure."


def _not_compared(why: str) -> str:
    return f" The end of the log was not compared with the healthy runs: {why}."


def _nearest(run: MonitorRun) -> str:
    """Return on which joint the residual came nearest to its threshold of that moment."""
    nearest = int(np.argmax(run.nearness))
    share, joint = percent(float(run.nearness[nearest])), run.joints[nearest]
    if run.nearness[nearest] > 1:
        return f" On {joint} the residual was above its threshold for a few ticks: {share} of it."
    return f" The residual came nearest to its threshold on {joint}: {share} of it."


def _tolerated(run: MonitorRun, said: Sequence[str]) -> str:
    """Return the joints without an event whose residual was above its threshold, and why that is no detection."""
    above = [j for j, near in zip(run.joints, run.nearness, strict=True) if near > 1 and j not in said]
    if not above:
        return ""
    return (
        f" On {listed(above)} the residual was above its threshold without a detection: for a few ticks, or near rest, "
        "where the friction of the model may be off."
    )


def _joints_of(events: Sequence[Event]) -> list[str]:
    return list(dict.fromkeys(j for e in events for j in e.joints))


def _at_the_end(run: MonitorRun) -> str:
    """Return the faults that are believed at the end, and those that are not isolated yet."""
    believed = [fault_words(t, run.robot, joint=True) for t in run.faults]
    undecided = [j for k, j in enumerate(run.joints) if STAGES[run.stages[-1, k]] is Stage.DETECTED]
    said = [f"At the end: {listed(believed)}."] if believed else []
    said += [f"The fault on {listed(undecided)} is not isolated yet."] if undecided else []
    return " ".join(said) or "No fault remains."


def _said(row: EventRow) -> Text:
    if row.stage == "detection":
        return clean(row.reason or "the residual left its threshold")
    lines = list(row.said)
    if row.verdict:
        lines[:1] = [f"{row.verdict}: {lines[0]}" if lines else row.verdict]
    if row.alternatives:
        lines.append(f"or {'; '.join(row.alternatives)}")
    said = clean("\n".join(lines))
    if row.reason:
        said.append_text(clean(("\n" if lines else "") + row.reason, "dim"))
    return said
