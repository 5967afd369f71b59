"""A trend in words: the short answer, and a sentence for each change."""

from __future__ import annotations

import math
from datetime import datetime

import numpy as np

from cdia_pin.fleet import Course, CourseTrend, FleetChange, FleetTrend, RobotTrend
from cdia_pin.fleet.alarm_limit import FEWEST_AFTER
from cdia_pin.fleet.fleet_effects import Role
from cdia_pin.fleet.regressors import LACKING, TEMPERATURE
from cdia_pin.fleet.step_search import FEWEST_BEFORE
from cdia_pin.phrases import NO_BREAK, counted
from cdia_pin.viewers.words import (
    few,
    listed,
    number,
    parameter_name,
    percent,
    with_interval,
    with_sign,
    with_unit,
)

WARMTH = "it moves friction more than wear does"
MOST_NAMED = 3  # robots or courses that a line names before it counts the others


def change_sentence(change: FleetChange) -> str:
    """Return ``coulomb friction of elbow_joint: +18 ± 4 % beyond temperature and load since 12 May 2026``.

    Args:
        change: One of a trend.
    """
    alarm = change.alarm
    beyond = listed(r.name for r in change.trend.regressors)
    since = day_words(alarm.since_time, alarm.since)
    gone = "" if alarm.lasting else ", which does not hold any more"
    grown = f", grown over {alarm.logs} logs" if alarm.is_growth else ""
    return (
        f"{course_words(change.trend.course)}: {size_words(change)}"
        f"{f' beyond {beyond}' if beyond else ''} since {since}{grown}{gone}"
    )


def course_words(course: Course) -> str:
    """Return ``coulomb friction of elbow_joint``, with the parameter where the effect has several.

    Args:
        course: The course.
    """
    name = course.effect.replace("_", " ")
    said = parameter_name(course.parameter)
    plain = course.parameter in ("level", "coefficient", "offset", "gain", "inertia")
    where = f" of {listed(course.joints)}" if course.joints else ""
    return f"{name}{'' if plain else f', {said},'}{where}"


def size_words(change: FleetChange) -> str:
    """Return the size of a change with its interval: in percent of the level before, where that is known.

    Args:
        change: One of a trend.
    """
    alarm, unit = change.alarm, change.trend.course.unit
    if unit != "1" and math.isfinite(alarm.growth):
        level = abs(alarm.level)
        share, half = 100 * alarm.size / level, 100 * alarm.half_width / level
        return with_sign(with_interval(share, (share - half, share + half), "%"), share)
    if unit == "1":  # a gain is a share already
        share, half = 100 * alarm.size, 100 * alarm.half_width
        return with_sign(with_interval(share, (share - half, share + half), "%"), share)
    ends = (alarm.size - alarm.half_width, alarm.size + alarm.half_width)
    return with_sign(with_interval(alarm.size, ends, unit), alarm.size)


def level_words(trend: CourseTrend) -> str:
    """Return the level of a parameter with its interval.

    Args:
        trend: A course with its trend.
    """
    ends = (trend.level - trend.half_width, trend.level + trend.half_width)
    return with_interval(trend.level, ends, trend.course.unit)


def slope_words(trend: CourseTrend) -> dict[str, str]:
    """Return by how much each regressor moves a parameter, with its interval, by the regressor's name.

    Args:
        trend: A course with its trend.
    """
    out = {}
    for r in trend.regressors:
        ends = (r.slope - r.half_width, r.slope + r.half_width)
        out[r.name] = with_interval(r.slope, ends, f"{trend.course.unit}/{r.unit}")
    return out


def day_words(at: datetime | None, log: str) -> str:
    """Return ``12 May 2026``, or the name of the log where nothing says when it was recorded.

    Args:
        at: The time.
        log: Name of the log.
    """
    return f"{at.day}{NO_BREAK}{at:%B}{NO_BREAK}{at.year}" if at is not None else log


def trend_answer(trend: FleetTrend) -> list[tuple[str, str]]:
    """Return the five lines that a maintainer must know, each with its head.

    Args:
        trend: The outcome of ``fleet_trend``.
    """
    lasting = [c for c in trend.changes if c.alarm.lasting]
    robots = list(dict.fromkeys(c.trend.course.robot for c in lasting))
    if lasting:
        first = lasting[0]
        said = f"{first.trend.course.robot}: {change_sentence(first)}"
        others = [r for r in robots if r != first.trend.course.robot]
        head = f"{len(robots)} of {counted(len(trend.robots), 'robot')} changed"
        lines = [(head, said + (f"; also {listed(few(others, MOST_NAMED))}" if others else ""))]
    else:
        lines = [("nothing changed", _what_was_judged(trend))]
    lines.append(("would be noticed", _noticed(trend)))
    lines.append(("temperature", _temperature(trend)))
    lines.append(("not compared", _not_compared(trend)))
    lines.append(("false alarms", _false_alarms(trend)))
    return lines


def _what_was_judged(trend: FleetTrend) -> str:
    judged = sum(len(r.judged) for r in trend.robots)
    if not judged:
        wearing = [t for r in trend.robots for t in r.trends if t.course.role is not Role.JOB]
        most = max((len(t.compared) for t in wearing), default=0)
        return (
            f"as far as can be told: a parameter has at most {counted(most, 'comparable log')}, and an alarm needs "
            f"more than {FEWEST_BEFORE + FEWEST_AFTER}"
        )
    return f"in {counted(judged, 'parameter')} of {counted(len(trend.robots), 'robot')}"


def is_level(trend: CourseTrend) -> bool:
    """Tell whether a level is larger than its own interval, so that a change can be a share of it.

    Args:
        trend: A course with its trend.
    """
    return abs(trend.level) > trend.half_width


def _noticed(trend: FleetTrend) -> str:
    """Return the growth of friction that a week of daily logs shows, in the median of all joints that rub."""
    friction = [t for r in trend.robots for t in r.judged if t.course.effect.endswith("friction")]
    if not friction:
        return "nothing yet: there are too few comparable logs of friction"
    shares = [t.noticed / abs(t.level) for t in friction if is_level(t)]
    if not shares:
        return "nothing in percent: no friction is larger than its own interval"
    if len(shares) == 1:
        return f"friction that grows by {percent(shares[0])} for seven logs, in the only parameter above its interval"
    return (
        f"friction that grows by {percent(float(np.median(shares)))} for seven logs, in the median of "
        f"{len(shares)} parameters ({percent(min(shares))} to {percent(max(shares))})"
    )


def _temperature(trend: FleetTrend) -> str:
    """Return by how much the temperature moves friction; where it was not taken out, why."""
    if not trend.settings.regressors:
        return f"left out, as asked; {WARMTH}"
    friction = [t for r in trend.robots for t in r.judged if t.course.effect.endswith("friction")]
    taken = [(t, g) for t in friction for g in t.regressors if g.name == TEMPERATURE]
    shares = [abs(g.slope / t.level) for t, g in taken if abs(g.slope) > g.half_width and is_level(t)]
    known = [float(np.isfinite(t.course.temperature[t.compared]).mean()) for t in friction]
    lacking = [
        (t.course.robot, share) for t, share in zip(friction, known, strict=True) if share <= 1 - LACKING
    ]
    robots = listed(few(list(dict.fromkeys(robot for robot, _ in lacking)), MOST_NAMED))
    of_them = "half of the logs or more lack it" if any(s for _, s in lacking) else "no log has it"
    beside = f"; not on {robots}: {of_them}" if lacking else ""
    if shares:
        median = percent(float(np.median(shares)))
        return f"taken out: it moves friction by {median} per kelvin in the median{beside}"
    if taken:
        return f"taken out; it hardly moves friction here{beside}"
    if lacking:
        return f"in no log; {WARMTH}" if not any(known) else f"not taken out: {of_them}; {WARMTH}"
    return f"not taken out: it hardly varies, or there are too few logs; {WARMTH}"


def _not_compared(trend: FleetTrend) -> str:
    courses = [t.course for r in trend.robots for t in r.trends if t.course.role is not Role.JOB]
    every = sum(len(c.logs) for c in courses)
    left = [why for c in courses for why in c.not_comparable if why]
    failed = sum(len(r.courses.failed) for r in trend.robots)
    said = f"{len(left)} of {counted(every, 'value')}"
    if left:
        kinds = {
            "the joint rests": " moves in ",
            "other speeds": "other speeds",
            "the motion hardly shows it": "the motion",
            "no temperature": "lacks the temperature",
            "no load": "lacks the load",
        }
        counts = {kind: sum(mark in why for why in left) for kind, mark in kinds.items()}
        said += f" ({listed(f'{kind}: {n}' for kind, n in counts.items() if n)})"
    undated = sum(not r.courses.dated for r in trend.robots)
    outdated = sum(r.courses.outdated for r in trend.robots)
    again = f"{counted(outdated, 'log')} of another setup or version: cdia fleet add fits what is there again"
    parts = [
        said,
        f"{counted(failed, 'log')} failed" if failed else "",
        again if outdated else "",
        f"logs without a date on {undated} of {counted(len(trend.robots), 'robot')}" if undated else "",
    ]
    return "; ".join(p for p in parts if p)


def _false_alarms(trend: FleetTrend) -> str:
    rate, years = trend.settings.false_alarms, trend.robot_years
    expected = (
        f"; {number(rate * years, 2)} expected in these {number(years, 2)} robot-years" if years else ""
    )
    return f"at most {number(rate, 2)} a year for each robot{expected}"


def agreement_words(robot: RobotTrend) -> list[str]:
    """Return what the courses with too few logs for an alarm show: which agree, and which do not.

    Args:
        robot: A robot of a trend.
    """
    few = [
        t for t in robot.trends if not t.is_judged and t.course.role is not Role.JOB and len(t.compared) > 1
    ]
    agree = [t for t in few if t.agrees]
    out = []
    if agree:
        widest = sorted(t.scatter / abs(t.level) for t in agree if t.course.effect.endswith("friction"))
        kinds = listed(sorted({t.course.effect.replace("_", " ") for t in agree}))
        said = (
            f"; friction scatters by {percent(widest[0])} to {percent(widest[-1])}" if len(widest) > 1 else ""
        )
        out.append(
            f"no drift shows in {len(agree)} of {counted(len(few), 'parameter')} ({kinds}): "
            f"they agree within their intervals{said}"
        )
    for t in few:
        if not t.agrees:
            values = t.course.value[t.compared]
            out.append(
                f"{course_words(t.course)} differs between the logs by more than its intervals: "
                f"{with_unit(f'{number(values.min())} to {number(values.max())}', t.course.unit)} in {len(values)} logs"
            )
    return out
