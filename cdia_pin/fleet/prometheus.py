"""The trend as a text of Prometheus, for the text file collector of its node exporter or any web server.

Names and labels follow the text exposition format 0.0.4.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from cdia_pin.fleet.course_trend import CourseTrend
from cdia_pin.fleet.fleet_effects import Role
from cdia_pin.fleet.trend import FleetTrend

# Name → help; all are gauges.
METRICS: Mapping[str, str] = {
    "cdia_robot_logs": "Logs of a robot that were fitted.",
    "cdia_robot_failed_logs": "Logs of a robot that gave nothing.",
    "cdia_robot_last_log_seconds": "When the last log of a robot was recorded, in seconds since 1970.",
    "cdia_robot_changes": "Changes of a robot that still hold.",
    "cdia_parameter_value": "A parameter in the last comparable log, in its unit.",
    "cdia_parameter_half_width": "Half width of its 95 % interval, in its unit.",
    "cdia_parameter_level": "A parameter at mean temperature and load, before a change if there is one.",
    "cdia_parameter_not_compared": "Logs in which a parameter is not compared.",
    "cdia_change_size": "Change of a parameter beyond temperature and load, in its unit.",
    "cdia_change_half_width": "Half width of the change's 95 % interval, in its unit.",
    "cdia_change_certainty": "Size of a change over its standard deviation.",
    "cdia_change_limit": "Limit of the certainty, from the stated rate of false alarms.",
    "cdia_change_since_seconds": "When a change began, in seconds since 1970.",
}


def prometheus_text(trend: FleetTrend) -> str:
    """Return a trend in the text format of Prometheus.

    Args:
        trend: The outcome of `fleet_trend`.
    """
    samples: dict[str, list[str]] = {name: [] for name in METRICS}
    for name, labels, value in _samples(trend):
        if math.isfinite(value):
            said = ",".join(f'{key}="{_escaped(text)}"' for key, text in labels.items())
            samples[name].append(f"{name}{{{said}}} {value:.10g}")
    lines = []
    for name, meaning in METRICS.items():
        lines += [f"# HELP {name} {meaning}", f"# TYPE {name} gauge", *samples[name]]
    return "\n".join(lines) + "\n"


def _samples(trend: FleetTrend) -> Iterator[tuple[str, dict[str, str], float]]:
    for robot in trend.robots:
        c, of_robot = robot.courses, {"robot": robot.robot}
        yield "cdia_robot_logs", of_robot, c.logs - len(c.failed)
        yield "cdia_robot_failed_logs", of_robot, len(c.failed)
        yield "cdia_robot_changes", of_robot, sum(x.alarm.lasting for x in robot.changes)
        times = [at.timestamp() for t in robot.trends for at in t.course.recorded if at is not None]
        yield "cdia_robot_last_log_seconds", of_robot, max(times, default=math.nan)
        for t in robot.trends:
            if t.course.role is not Role.JOB:
                yield from _parameter(t)
    for change in trend.changes:
        if change.alarm.lasting:
            labels, alarm = _labels(change.trend), change.alarm
            yield "cdia_change_size", labels, alarm.size
            yield "cdia_change_half_width", labels, alarm.half_width
            yield "cdia_change_certainty", labels, alarm.certainty
            yield "cdia_change_limit", labels, change.trend.limit
            since = math.nan if alarm.since_time is None else alarm.since_time.timestamp()
            yield "cdia_change_since_seconds", labels, since


def _parameter(trend: CourseTrend) -> Iterator[tuple[str, dict[str, str], float]]:
    c, labels = trend.course, _labels(trend)
    yield "cdia_parameter_not_compared", labels, float(np.sum(~c.use))
    if len(trend.compared):
        last = trend.compared[-1]
        yield "cdia_parameter_value", labels, float(c.value[last])
        yield "cdia_parameter_half_width", labels, float(c.half_width[last])
        yield "cdia_parameter_level", labels, trend.level


def _labels(trend: CourseTrend) -> dict[str, str]:
    c = trend.course
    return {
        "robot": c.robot,
        "effect": c.effect,
        "joint": "+".join(c.joints),
        "parameter": c.parameter,
        "unit": c.unit,
    }


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
