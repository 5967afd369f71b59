"""Findings on the signs, the order of joints, the unit of angle and the mounting of a log."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cdia_pin.logs.checks.conventions import (
    DEGREE,
    LIKELY,
    SEARCH_SAMPLES,
    ConventionChange,
    Conventions,
    ConventionSearch,
    Trial,
    search_conventions,
)
from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.motion import SmoothedMotion
from cdia_pin.logs.checks.mounting import turn_of, upright
from cdia_pin.logs.log import Log

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

UNDECIDED = 0.3  # [1], difference in misfit that is within the noise of a good log
POOR = 0.5  # [1], unexplained share above which friction and the URDF are not the main part of an effort

STEEPEST = 60.0  # [°], turn of gravity that the effect of a tilted base can still be fitted to
TOO_FAST = 5.0  # [1], speed over the URDF's limit that no arm reaches; degrees read as rad make 57


class Difference(NamedTuple):
    """What the conventions of a log have other than assumed.

    Attributes:
        topic: Property of the log.
        message: What is different.
        advice: What to do.
        joints: Names of the joints concerned.
        severity: How much it matters.
    """

    topic: Topic
    message: str
    advice: str
    joints: list[str]
    severity: Severity = Severity.ERROR


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
    likely = [t for t in search.rest if t.gain > LIKELY]
    if likely:
        for d in _differences(log, robot, search.conventions, likely[0].conventions):
            yield Finding(
                d.topic,
                Severity.WARNING,
                f"perhaps {d.message}: that would fit better, but not by enough to be sure",
                joint=d.joints[0] if len(d.joints) == 1 else None,
                advice=f"look at another log; if so, {d.advice}",
                value={"joints": d.joints, "gain": likely[0].gain},
            )
    yield _signs(log, search)
    if robot.n > 1:
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
    for d in _differences(log, robot, search.start, search.conventions):
        worst = max(d.joints, key=lambda j: np.nan_to_num(search.before[log.joints.index(j)]))
        k = log.joints.index(worst)
        others = [
            other.message
            for before, r in rivals
            if set(d.joints) & {log.joints[i] for i in r.joints}
            for other in _differences(log, robot, before, r.conventions)
            if other.message != d.message
        ]
        yield Finding(
            d.topic,
            d.severity,
            f"{d.message}: the unexplained share of the effort of {worst} falls from {search.before[k]:.0%} to "
            f"{search.after[k]:.0%}"
            + (f"; about as likely: {' / '.join(list(dict.fromkeys(others))[:3])}" if others else ""),
            joint=d.joints[0] if len(d.joints) == 1 else None,
            advice=d.advice,
            value={"joints": d.joints, "alternatives": others, "before": _by_name(log, search.before)},
        )


def _differences(log: Log, robot: RobotModel, old: Conventions, new: Conventions) -> list[Difference]:
    """Return the differences between two conventions."""
    said: list[Difference] = []
    if new.angle != old.angle:
        revolute = [j for j, slides in zip(log.joints, robot.is_prismatic, strict=True) if not slides]
        said.append(
            Difference(Topic.UNITS, "positions are in degrees, not rad", "--convert angle=deg", revolute)
        )
    if new.gravity is not None and new.gravity != old.gravity:
        said.append(_mounted(robot, np.array(new.gravity)))
    moved = _moved(log.joints, old.position_column, new.position_column)
    if moved:
        renames = ",".join(f"{column}={joint}" for joint, column in moved.items())
        said.append(
            Difference(
                Topic.JOINT_ORDER,
                f"the columns hold other joints ({_said(moved)})",
                f"--joint-map {renames}",
                [*moved],
            )
        )
    moved = _moved(log.joints, old.effort_column, new.effort_column)
    if moved and new.effort_column != new.position_column:
        said.append(
            Difference(
                Topic.JOINT_ORDER,
                f"the efforts, but not the positions, are those of other joints ({_said(moved)})",
                "rename the effort columns",
                [*moved],
            )
        )
    position = _turned(log.joints, old.position_sign, new.position_sign)
    effort = _turned(log.joints, old.effort_sign, new.effort_sign)
    both = [j for j in position if j in effort]
    signs = (
        (both, "position, velocity and effort have the opposite sign", ("flip_position", "flip_effort")),
        (
            [j for j in position if j not in both],
            "position and velocity have the opposite sign",
            ("flip_position",),
        ),
        (
            [j for j in effort if j not in both],
            "the effort has the opposite sign and would feed energy into the joint",
            ("flip_effort",),
        ),
    )
    for joints, message, keys in signs:
        if joints:
            flags = " ".join(f"--convert {key}={','.join(joints)}" for key in keys)
            said.append(Difference(Topic.SIGN, f"{message} on {', '.join(joints)}", flags, joints))
    return said


def _mounted(robot: RobotModel, gravity: np.ndarray) -> Difference:
    """Describe how the base stands: by gravity in the base, and by its turn from the URDF's."""
    turn = turn_of(gravity, robot.gravity_vector)
    vector = ", ".join(f"{g:.2g}" for g in np.where(np.abs(gravity) < 0.05, 0.0, gravity))
    message = f"the base stands {turn:.0f}° from the URDF's (gravity in the base is about ({vector}) m/s²)"
    roll, pitch = upright(gravity)
    urdf = f'hang the base in the URDF on a fixed joint with rpy="{roll:.3g} {pitch:.3g} 0"'
    if turn > STEEPEST:
        return Difference(Topic.MOUNTING, message, urdf, list(robot.joints))
    advice = f"'cdia discover --mounted tilted' fits it; or {urdf}"
    return Difference(Topic.MOUNTING, message, advice, list(robot.joints), Severity.WARNING)


def _moved(joints: Sequence[str], old: Sequence[int], new: Sequence[int]) -> dict[str, str]:
    """Return, for each joint whose column changes, the joint whose column holds its numbers."""
    return {joints[k]: joints[new[k]] for k in range(len(joints)) if new[k] != old[k]}


def _turned(joints: Sequence[str], old: Sequence[int], new: Sequence[int]) -> list[str]:
    return [j for j, a, b in zip(joints, old, new, strict=True) if a != b]


def _said(moved: dict[str, str]) -> str:
    return ", ".join(f"{column} holds {joint}" for joint, column in moved.items())


def _by_name(log: Log, share: np.ndarray) -> dict[str, float]:
    return {j: float(s) for j, s in zip(log.joints, share, strict=True) if np.isfinite(s)}


def find_conventions(
    log: Log, motion: SmoothedMotion, robot: RobotModel
) -> tuple[ConventionSearch, list[Finding]]:
    """Search the conventions that fit; angles that are degrees by their size are taken as such from the start.

    Args:
        log: The log.
        motion: Its motion, smoothed.
        robot: Its robot.

    Returns:
        The search, and the finding that positions are in degrees by their size, if they are.
    """
    motion = motion.thin(SEARCH_SAMPLES)
    search = search_conventions(motion, robot)
    largest = _angle_out_of_reach(log, robot)
    against = next((t.gain for t in search.rest if t.kind is ConventionChange.DEGREES), 0.0)
    if largest is None or search.conventions.angle != 1.0 or against <= -LIKELY:
        return search, []
    degrees = replace(Conventions.assumed(robot.n), angle=DEGREE)
    finding = Finding(
        Topic.UNITS,
        Severity.ERROR,
        f"positions up to {largest:.4g} are several turns as rad, within limits as degrees",
        advice="--convert angle=deg",
        value={"largest": largest},
    )
    return search_conventions(motion, robot, degrees), [finding]


def _angle_out_of_reach(log: Log, robot: RobotModel) -> float | None:
    """Return the largest position that no joint reaches in rad, if all are within the URDF's limits as degrees.

    A joint without limits of position may make many turns; only its speed tells that they are degrees.
    """
    limits = robot.limits
    revolute = ~robot.is_prismatic
    limited = np.isfinite(limits.lower) & np.isfinite(limits.upper)
    most = np.abs(log.position).max(axis=0)
    speed = np.abs(np.diff(log.position, axis=0) / np.diff(log.time)[:, None])
    usual = np.percentile(speed, 90, axis=0)  # single wild samples do not count
    as_degrees = log.position * DEGREE
    fits = (as_degrees > limits.lower - 0.01) & (as_degrees < limits.upper + 0.01)
    turns = np.maximum(2 * np.pi, np.where(limited, limits.upper, 0.0))
    beyond = revolute & (most > 1.2 * turns) & (limited | (usual > TOO_FAST * limits.velocity))
    return float(most[beyond].max()) if beyond.any() and fits[:, revolute].all() else None


def _signs(log: Log, search: ConventionSearch) -> Finding:
    """Report the joints whose sign is certain, and those whose axis may be reversed."""
    single = [t for t in search.rest if len(t.joints) == 1]
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
        parts.append(f"cannot exclude that {', '.join(mirrored)} is reversed in position and effort together")
    if not flips:
        parts.append("cannot determine signs: no joint moves")
    return Finding(
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
    shown = ", ".join(pairs[:4]) + (f" and {len(pairs) - 4} more" if len(pairs) > 4 else "")
    return Finding(
        Topic.JOINT_ORDER,
        Severity.INFO,
        f"no exchange of two joints fits better; this motion cannot exclude {shown}",
        advice="the names of the columns decide; move these joints by different amounts to test it",
        value=value,
    )
