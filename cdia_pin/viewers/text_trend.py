"""A fleet in the terminal: the short answer of a trend, what changed, and the state of a store."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table

from cdia_pin.fleet import FleetTrend, RobotTrend
from cdia_pin.fleet.fleet_effects import Role
from cdia_pin.fleet.status import FleetStatus
from cdia_pin.viewers.cells import add_row, clean, new_table
from cdia_pin.viewers.trend_words import (
    agreement_words,
    course_words,
    day_words,
    level_words,
    size_words,
    slope_words,
    trend_answer,
)
from cdia_pin.viewers.words import listed, number

MOST_CHANGES = 20  # of a fleet that are listed; the rest with everything


def trend_table(trend: FleetTrend, everything: bool = False) -> RenderableType:
    """Return the short answer, and the changes, the surest first; on request also every course.

    Args:
        trend: The outcome of ``fleet_trend``.
        everything: Whether every change and every course is shown.
    """
    answer = Table.grid(padding=(0, 2))
    answer.add_column(no_wrap=True)
    answer.add_column()
    style = "yellow" if any(c.alarm.lasting for c in trend.changes) else "green"
    for k, (head, text) in enumerate(trend_answer(trend)):
        answer.add_row(clean(head, f"bold {style}" if k == 0 else "bold"), clean(text))
    parts: list[RenderableType] = [Padding(answer, (0, 1))]
    if trend.changes:
        parts.append(_changes(trend, everything))
    for robot in trend.robots:
        parts += [Padding(clean(f"{robot.robot}: {s}."), (0, 1)) for s in agreement_words(robot)]
        if everything:
            parts.append(_courses(robot))
    return Group(*parts)


def status_table(status: FleetStatus) -> RenderableType:
    """Return what a store holds, robot by robot, and why logs failed.

    Args:
        status: Of `fleet_status`.
    """
    table = new_table("robot", "logs", "failed", "older setup", "from", "to", left=(0, 4, 5))
    for r in status.robots:
        first, last = (day_words(at, "no date") for at in (r.first, r.last))
        add_row(table, r.robot, str(r.logs), str(len(r.failed)), str(r.outdated), first, last)
    parts: list[RenderableType] = [table]
    for r in status.robots:
        parts += [Padding(clean(f"{r.robot}: {log} failed: {why}"), (0, 1)) for log, why in r.failed.items()]
    return Group(*parts)


def _changes(trend: FleetTrend, everything: bool) -> Table:
    heads = ("robot", "changed", "by ± 95 %", "since", "noticed", "certainty", "limit", "moved along")
    table = new_table(*heads, left=(0, 1, 2, 3, 4, 7))
    shown = trend.changes if everything else trend.changes[:MOST_CHANGES]
    for c in shown:
        alarm = c.alarm
        add_row(
            table,
            c.trend.course.robot,
            course_words(c.trend.course),
            size_words(c),
            day_words(alarm.since_time, alarm.since),
            day_words(alarm.raised_time, alarm.raised),
            number(alarm.certainty, 2),
            number(c.trend.limit, 2),
            listed(course_words(t.course) for t in c.along),
            style="" if alarm.lasting else "dim",
        )
    if len(shown) < len(trend.changes):
        table.caption = f"{len(trend.changes) - len(shown)} more with --all"
    return table


def _courses(robot: RobotTrend) -> Table:
    heads = (f"{robot.robot}: parameter", "level ± 95 %", "spread", "logs", "temperature", "load")
    table = new_table(*heads, left=(0, 1, 4, 5))
    for t in robot.trends:
        if t.course.role is Role.JOB or not len(t.compared):
            continue
        slopes = slope_words(t)
        add_row(
            table,
            course_words(t.course),
            level_words(t),
            number(t.spread, 2) if t.is_judged else "–",
            f"{len(t.compared)} of {len(t.course.logs)}",
            slopes.get("temperature", "–"),
            slopes.get("load", "–"),
        )
    return table
