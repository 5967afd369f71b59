"""Findings on the signs, the order of joints, the unit of angle and the mounting of a log."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.logs.checks.conventions import LIKELY, ConventionChange, ConventionSearch, Trial
from cdia_pin.logs.checks.differences import differences
from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.log import Log

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

UNDECIDED = 0.3  # [1], difference in misfit that is within the noise of a good log
POOR = 0.5  # [1], unexplained share above which friction and the URDF are not the main part of an effort


def check_conventions(log: Log, robot: RobotModel, search: ConventionSearch) -> Iterator[Finding]:
    """Report the search for conventions that fit the model better.

    Args:
        log: The log.
        robot: Its robot.
        search: Result of the search.

    Yields:
        Findings on units, signs and order, and on efforts that fit badly.
    """
    yield from _adopted(log, robot, search)
    if search.possible is not None:
        for d in differences(robot, search.conventions, search.possible.conventions):
            yield Finding(
                d.topic,
                Severity.WARNING,
                f"perhaps {d.message}: that would fit better, but not by enough to be sure",
                joint=d.joints[0] if len(d.joints) == 1 else None,
                advice=f"look at another log; if so, {d.advice}",
                value={"joints": d.joints, "gain": search.possible.gain},
            )
    yield from _signs(log, robot, search)
    reordered = search.possible is not None and search.possible.kind is ConventionChange.ORDER
    if robot.n > 1 and not reordered:
        yield _order(log, search)
    for k in np.flatnonzero(search.after > POOR).tolist():
        yield Finding(
            Topic.EFFORT_KIND,
            Severity.INFO,
            f"{search.after[k]:.0%} of its effort is neither rigid-body torque, friction nor rotor inertia: "
            "a payload, a tilted base or an external force, which 'cdia discover' can find; or another signal",
            joint=log.joints[k],
            value={"unexplained": float(search.after[k])},
        )


def _adopted(log: Log, robot: RobotModel, search: ConventionSearch) -> Iterator[Finding]:
    """Report all adopted changes together, and the rivals that fit as well."""
    done = {(best.kind, best.joints) for best, _ in search.steps}
    begun = [search.start, *(best.conventions for best, _ in search.steps)]
    rivals = [
        (before, r)
        for before, (_, among) in zip(begun, search.steps, strict=False)
        for r in among
        if (r.kind, r.joints) not in done
    ]
    for d in differences(robot, search.start, search.conventions):
        worst = max(d.joints, key=lambda j: np.nan_to_num(search.before[log.joints.index(j)]))
        k = log.joints.index(worst)
        others = [
            other.message
            for before, r in rivals
            if set(d.joints) & {log.joints[i] for i in r.joints}
            for other in differences(robot, before, r.conventions)
            if other.message != d.message
        ]
        yield Finding(
            d.topic,
            d.severity,
            f"{d.message}: the unexplained share of the effort of {worst} "
            f"{'falls' if search.after[k] < search.before[k] else 'goes'} from {search.before[k]:.0%} to "
            f"{search.after[k]:.0%}"
            + (f"; about as likely: {' / '.join(list(dict.fromkeys(others))[:3])}" if others else ""),
            joint=d.joints[0] if len(d.joints) == 1 else None,
            advice=d.advice,
            value={"joints": d.joints, "alternatives": others, "before": _by_name(log, search.before)},
        )


def _by_name(log: Log, share: np.ndarray) -> dict[str, float]:
    return {j: float(s) for j, s in zip(log.joints, share, strict=True) if np.isfinite(s)}


def _signs(log: Log, robot: RobotModel, search: ConventionSearch) -> Iterator[Finding]:
    """Report the joints whose sign is certain, and those whose axis may be reversed; no joint whose sign is wrong."""
    changes = differences(robot, search.start, search.conventions)
    wrong = {log.joints.index(j) for d in changes if d.topic is Topic.SIGN for j in d.joints}
    single = [t for t in search.rest if len(t.joints) == 1 and t.joints[0] not in wrong]
    flips = {t.joints[0]: -t.gain for t in single if t.kind is ConventionChange.EFFORT_SIGN}
    sure = [log.joints[k] for k in sorted(flips) if flips[k] > LIKELY]
    unsure = [log.joints[k] for k in sorted(flips) if flips[k] <= LIKELY]
    open_axes = sorted(
        t.joints[0] for t in single if t.kind is ConventionChange.BOTH_SIGNS and t.gain > -UNDECIDED
    )
    mirrored = [log.joints[k] for k in open_axes]
    parts = []
    if sure:
        parts.append(f"efforts fit the model and oppose friction on {', '.join(sure)}")
    if unsure:
        parts.append(f"cannot determine the sign of the effort on {', '.join(unsure)}")
    if mirrored:
        each = "is" if len(mirrored) == 1 else "are each"
        parts.append(
            f"cannot exclude that {', '.join(mirrored)} {each} reversed in position and effort together"
        )
    if not flips and not wrong:
        parts.append("cannot determine signs: no joint moves")
    if parts:
        yield Finding(
            Topic.SIGN,
            Severity.INFO if unsure or mirrored or not flips else Severity.OK,
            "; ".join(parts),
            value={"sure": sure, "cannot_tell": unsure, "axis_cannot_tell": mirrored},
        )


def _order(log: Log, search: ConventionSearch) -> Finding:
    """Report the joints that could be exchanged without a worse fit."""
    swaps = [t for t in search.rest if t.kind is ConventionChange.ORDER and len(t.joints) == 2]
    open_pairs: list[Trial] = [t for t in swaps if t.gain > -UNDECIDED]
    pairs = [" ↔ ".join(log.joints[k] for k in t.joints) for t in open_pairs]
    value = {"cannot_tell": [[log.joints[k] for k in t.joints] for t in open_pairs]}
    if not swaps:
        return Finding(
            Topic.JOINT_ORDER,
            Severity.INFO,
            "cannot determine the order of the joints: no joint moves",
            value=value,
        )
    if not pairs:
        message = "no exchange of two joints fits as well as the order of the log"
        return Finding(Topic.JOINT_ORDER, Severity.OK, message, value=value)
    none = "" if open_pairs[0].gain > UNDECIDED else "no exchange of two joints fits better; "
    shown = ", ".join(pairs[:4]) + (f" and {len(pairs) - 4} more" if len(pairs) > 4 else "")
    return Finding(
        Topic.JOINT_ORDER,
        Severity.INFO,
        f"{none}this motion cannot exclude {shown}",
        advice="the names of the columns decide; move these joints by different amounts to test it",
        value=value,
    )
