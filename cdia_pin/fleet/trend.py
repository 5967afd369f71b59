"""The trend of a fleet: what changed on which robot, the surest first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cdia_pin.errors import CdiaError
from cdia_pin.fleet.alarm_limit import alarm_limit
from cdia_pin.fleet.course import Course, RobotCourses, courses_of
from cdia_pin.fleet.course_trend import Alarm, CourseTrend, trend_of
from cdia_pin.fleet.fleet_effects import Role
from cdia_pin.fleet.regressors import with_regressors
from cdia_pin.fleet.store import FleetStore
from cdia_pin.phrases import counted
from cdia_pin.progress import Progress, silent

DAYS_PER_YEAR = 365.25  # [days], with leap years
LOGS_PER_YEAR = DAYS_PER_YEAR  # where logs do not say when they were recorded: one a day
# Certainty of what was looked for over that of the surest course on its joint [1], from which it names the change: what
# leaks from one effect into another is weaker.
SUBSTANTIAL = 0.5
LEAST_DAYS = 1.0  # [days] of a course, so that logs of one hour do not make millions a year


@dataclass(frozen=True)
class TrendSettings:
    """When a change is an alarm.

    Attributes:
        false_alarms: Mean number of false alarms of one robot in a year [1/year]. All courses of a robot share it.
        regressors: Whether temperature and load may explain a part of a course.
    """

    false_alarms: float = 0.1
    regressors: bool = True


@dataclass(frozen=True, repr=False)
class FleetChange:
    """A change of a robot: the course that names it, and others that moved at the same time.

    Attributes:
        trend: The course that names it, with its alarm.
        along: Other courses of the robot whose alarms began before this one was raised, and the other way round.
    """

    trend: CourseTrend
    along: tuple[CourseTrend, ...]

    def __repr__(self) -> str:
        return f"FleetChange({self.trend!r}, {len(self.along)} along)"

    @property
    def alarm(self) -> Alarm:
        """The alarm."""
        assert self.trend.alarm is not None
        return self.trend.alarm


@dataclass(frozen=True, repr=False)
class RobotTrend:
    """The courses of a robot and their changes.

    Attributes:
        courses: What the store has of the robot.
        trends: Each course with its trend.
        changes: What changed, the surest first.
    """

    courses: RobotCourses
    trends: tuple[CourseTrend, ...]
    changes: tuple[FleetChange, ...]

    def __repr__(self) -> str:
        return f"RobotTrend({self.courses.robot}: {counted(len(self.changes), 'change')})"

    @property
    def robot(self) -> str:
        """Name of the robot."""
        return self.courses.robot

    @property
    def judged(self) -> tuple[CourseTrend, ...]:
        """The courses that have enough logs for an alarm, without those that change with the job."""
        return tuple(t for t in self.trends if t.is_judged and t.course.role is not Role.JOB)


@dataclass(frozen=True, repr=False)
class FleetTrend:
    """The outcome of `fleet_trend`.

    Attributes:
        robots: The robots, by name.
        settings: When a change is an alarm.
    """

    robots: tuple[RobotTrend, ...]
    settings: TrendSettings

    def __repr__(self) -> str:
        return f"FleetTrend({counted(len(self.robots), 'robot')}, {counted(len(self.changes), 'change')})"

    @cached_property
    def changes(self) -> tuple[FleetChange, ...]:
        """The changes of all robots, those that still hold first, then the surest first."""
        every = [c for r in self.robots for c in r.changes]
        return tuple(sorted(every, key=lambda c: (not c.alarm.lasting, -c.alarm.certainty)))

    @property
    def robot_years(self) -> float:
        """Time over which the robots were watched [years], as far as their logs are dated."""
        return float(np.nansum([r.courses.days for r in self.robots])) / DAYS_PER_YEAR


def fleet_trend(
    store: FleetStore, settings: TrendSettings | None = None, progress: Progress | None = None
) -> FleetTrend:
    """Look for changes of the parameters of all robots of a store, beyond what temperature and load explain.

    Args:
        store: The store.
        settings: The rate of false alarms.
        progress: Called with a sentence and the share done, from 0 to 1.

    Returns:
        The courses and the changes.

    Raises:
        FleetError: If the store cannot be read.
        CdiaError: If the rate of false alarms is not above zero.
    """
    settings, tell = settings or TrendSettings(), progress or silent
    if not 0 < settings.false_alarms < float("inf"):
        raise CdiaError(f"the rate of false alarms must be above 0 a year, given {settings.false_alarms:g}")
    tell("reading the store", 0.0)
    robots, every = [], list(courses_of(store))
    for k, courses in enumerate(every):
        tell(f"courses of {courses.robot}", k / len(every))
        robots.append(_robot_trend(courses, settings))
    return FleetTrend(tuple(robots), settings)


def _robot_trend(courses: RobotCourses, settings: TrendSettings) -> RobotTrend:
    if settings.regressors:
        courses = replace(courses, courses=tuple(map(with_regressors, courses.courses)))
    watched = sum(c.role is not Role.JOB and bool(c.use.any()) for c in courses.courses)
    share = settings.false_alarms / max(watched, 1)  # of each course [1/year]
    trends = []
    for course in courses.courses:
        limit = alarm_limit(_logs_per_year(course, courses) / share)
        trend = trend_of(course, limit, temperature=settings.regressors)
        trends.append(replace(trend, alarm=None) if course.role is Role.JOB else trend)
    return RobotTrend(courses, tuple(trends), tuple(_changes(trends)))


def _logs_per_year(course: Course, courses: RobotCourses) -> float:
    if not courses.dated:
        return LOGS_PER_YEAR
    return float(course.use.sum()) / max(courses.days, LEAST_DAYS) * DAYS_PER_YEAR


def _changes(trends: Sequence[CourseTrend]) -> list[FleetChange]:
    """Return the changes: an alarm that overlaps with a surer one in time is a part of it."""
    left = sorted((t for t in trends if t.alarm), key=_certainty, reverse=True)
    out = []
    while left:
        first, *others = left
        along = [t for t in others if _overlap(first, t)]
        left = [t for t in others if t not in along]
        cause = _cause(first, along)
        out.append(FleetChange(cause, tuple(t for t in (first, *along) if t is not cause)))
    return out


def _cause(first: CourseTrend, along: Sequence[CourseTrend]) -> CourseTrend:
    """Return the course that names a change: the surest, or what was looked for beside it on the same joint.

    What is looked for is fitted beside friction and offsets, so they do not move it. They are fitted without it, so it
    moves them: a drive that weakens seems to rub more.
    """
    if first.course.role is Role.SEARCHED:
        return first
    least = SUBSTANTIAL * _certainty(first)
    beside = [t for t in along if t.course.role is Role.SEARCHED and t.course.joints == first.course.joints]
    return max((t for t in beside if _certainty(t) >= least), key=_certainty, default=first)


def _certainty(trend: CourseTrend) -> float:
    return 0.0 if trend.alarm is None else trend.alarm.certainty


def _overlap(one: CourseTrend, other: CourseTrend) -> bool:
    """Tell whether each of two changes began before the other one was noticed and complete."""
    (a, b), (c, d) = _span(one), _span(other)
    return a <= d and c <= b


def _span(trend: CourseTrend) -> tuple[int, int]:
    """Return the first and the last log of a change, from its onset to its alarm and its full size."""
    course, alarm = trend.course, trend.alarm
    assert alarm is not None
    since, raised = course.logs.index(alarm.since), course.logs.index(alarm.raised)
    return min(since, raised), max(raised, since + alarm.logs - 1)
