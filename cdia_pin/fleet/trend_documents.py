"""The JSON of a trend, schema ``cdia-trend/1``."""

from __future__ import annotations

from datetime import datetime
from typing import TypedDict

from cdia_pin import schemas
from cdia_pin.fleet.course_trend import CourseTrend
from cdia_pin.fleet.trend import FleetChange, FleetTrend, RobotTrend
from cdia_pin.version import __version__


class ChangeRecord(TypedDict):
    """A change; keys as the attributes of `Alarm`, with the course that shows it."""

    robot: str
    effect: str
    joints: list[str]
    parameter: str
    unit: str
    since: str | None
    since_log: str
    raised: str | None
    raised_log: str
    size: float
    ci95: list[float]
    level: float
    growth: float
    certainty: float
    limit: float
    lasting: bool
    logs: int
    beyond: list[str]
    along: list[str]


class CourseRecord(TypedDict):
    """A course with its trend; one number for each log, null where nothing is known."""

    effect: str
    joints: list[str]
    parameter: str
    unit: str
    role: str
    model_value: float
    level: float
    half_width: float
    spread: float
    limit: float
    judged: bool
    regressors: list[dict[str, object]]
    logs: list[str]
    recorded: list[str | None]
    value: list[float]
    ci95_half_width: list[float]
    temperature: list[float]
    load: list[float]
    not_comparable: list[str]


def trend_document(trend: FleetTrend) -> dict[str, object]:
    """Return the JSON of a trend.

    Args:
        trend: The outcome of `fleet_trend`.
    """
    return {
        "schema": schemas.TREND,
        "version": __version__,
        "false_alarms_per_robot_and_year": trend.settings.false_alarms,
        "regressors": trend.settings.regressors,
        "robot_years": trend.robot_years,
        "changes": [change_record(c) for c in trend.changes],
        "robots": [_robot(r) for r in trend.robots],
    }


def change_record(change: FleetChange) -> ChangeRecord:
    """Return a change for JSON.

    Args:
        change: One of a trend.
    """
    course, alarm = change.trend.course, change.alarm
    return {
        "robot": course.robot,
        "effect": course.effect,
        "joints": [*course.joints],
        "parameter": course.parameter,
        "unit": course.unit,
        "since": _iso(alarm.since_time),
        "since_log": alarm.since,
        "raised": _iso(alarm.raised_time),
        "raised_log": alarm.raised,
        "size": alarm.size,
        "ci95": [alarm.size - alarm.half_width, alarm.size + alarm.half_width],
        "level": alarm.level,
        "growth": alarm.growth,
        "certainty": alarm.certainty,
        "limit": change.trend.limit,
        "lasting": alarm.lasting,
        "logs": alarm.logs,
        "beyond": [r.name for r in change.trend.regressors],
        "along": [t.course.label for t in change.along],
    }


def _robot(robot: RobotTrend) -> dict[str, object]:
    c = robot.courses
    return {
        "robot": c.robot,
        "logs": c.logs,
        "days": c.days,
        "dated": c.dated,
        "failed": c.failed,
        "outdated": c.outdated,
        "courses": [_course(t) for t in robot.trends],
    }


def _course(trend: CourseTrend) -> CourseRecord:
    c = trend.course
    return {
        "effect": c.effect,
        "joints": [*c.joints],
        "parameter": c.parameter,
        "unit": c.unit,
        "role": str(c.role),
        "model_value": c.model_value,
        "level": trend.level,
        "half_width": trend.half_width,
        "spread": trend.spread,
        "limit": trend.limit,
        "judged": trend.is_judged,
        "regressors": [
            {"name": r.name, "unit": r.unit, "slope": r.slope, "ci95_half_width": r.half_width}
            for r in trend.regressors
        ],
        "logs": [*c.logs],
        "recorded": [_iso(at) for at in c.recorded],
        "value": c.value.tolist(),
        "ci95_half_width": c.half_width.tolist(),
        "temperature": c.temperature.tolist(),
        "load": c.load.tolist(),
        "not_comparable": [*c.not_comparable],
    }


def _iso(at: datetime | None) -> str | None:
    return None if at is None else at.isoformat()
