"""What `cdia trend` says of a simulated fleet, beside what was hidden."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.fleet.plan import FleetRobotPlan, Hidden
from cdia_pin.fleet import CourseTrend, FleetTrend, RobotTrend
from cdia_pin.fleet.alarm_limit import alarm_limit, run_length
from cdia_pin.fleet.trend import DAYS_PER_YEAR

RATES = (0.1, 1.0, 10.0)  # stated rates of false alarms [1/robot/year] at which they are counted


@dataclass(frozen=True)
class FaultOutcome:
    """A hidden fault and what was said of it.

    Attributes:
        robot: Name of the robot.
        hidden: The fault.
        joint: Name of its joint.
        found: Whether its robot has a change that was noticed after the fault began.
        named: Effect and joint of the surest change; empty if there is none.
        right: Whether these are the fault's.
        size: Size that is said, in the fault's unit; NaN where it is not named right.
        half_width: Half width of its 95 % interval.
        delay: Logs from the first one with the fault to the alarm, both counted; NaN if not found.
        bound: The same for the best CUSUM, which knows the size of the fault, the level and the spread.
    """

    robot: str
    hidden: Hidden
    joint: str
    found: bool
    named: str
    right: bool
    size: float
    half_width: float
    delay: float
    bound: float


def fault_outcomes(
    trend: FleetTrend, plans: Sequence[FleetRobotPlan], joints: Sequence[str]
) -> Iterator[FaultOutcome]:
    """Yield what was said of each hidden fault.

    Args:
        trend: Of the fleet.
        plans: The robots.
        joints: Names of the joints.
    """
    by_name = {r.robot: r for r in trend.robots}
    for plan in plans:
        if plan.hidden is not None:
            yield _of_fault(by_name[plan.name], plan, plan.hidden, joints[plan.hidden.joint])


def _of_fault(robot: RobotTrend, plan: FleetRobotPlan, hidden: Hidden, joint: str) -> FaultOutcome:
    began = plan.date(hidden.day)
    after = [c for c in robot.changes if c.alarm.raised_time is not None and c.alarm.raised_time >= began]
    truth = f"{hidden.effect}@{joint}"
    own = next(t for t in robot.trends if t.course.effect == hidden.effect and t.course.joints == (joint,))
    bound = _bound(own, hidden, plan.days)
    if not after:
        return FaultOutcome(robot.robot, hidden, joint, False, "", False, *(math.nan,) * 3, bound)
    course, alarm = after[0].trend.course, after[0].alarm
    named = f"{course.effect}@{'+'.join(course.joints)}"
    # the first alarm of all that belong to the change
    raised = min(t.alarm.raised_time for t in (after[0].trend, *after[0].along) if t.alarm)  # type: ignore[type-var]
    delay = (max(raised, began) - began).days + 1.0  # type: ignore[type-var, operator]
    right = named == truth
    size, half = (alarm.size, alarm.half_width) if right else (math.nan, math.nan)
    return FaultOutcome(robot.robot, hidden, joint, True, named, right, size, half, delay, bound)


def _bound(own: CourseTrend, hidden: Hidden, days: int) -> float:
    """Return the delay of the best CUSUM [logs] [Lorden1971].

    Its sum must gain the logarithm of the logs to a false alarm.
    """
    needed, gained = math.log(run_length(own.limit)), 0.0
    for day in range(hidden.day, days):
        gained += (hidden.at(day) / own.spread) ** 2 / 2
        if gained >= needed:
            return float(day - hidden.day + 1)
    return math.nan


def healthy_years(plans: Iterable[FleetRobotPlan]) -> float:
    """Return the time in which no robot had a fault [years]."""
    return sum(p.hidden.day if p.hidden else p.days for p in plans) / DAYS_PER_YEAR


def false_alarms(trend: FleetTrend, plans: Sequence[FleetRobotPlan], rate: float) -> tuple[int, int]:
    """Return how many courses, and how many robots, gave an alarm although nothing was wrong yet.

    Args:
        trend: Of the fleet.
        plans: The robots.
        rate: Stated rate [1/robot/year].
    """
    healthy = {p.name: p.hidden.day if p.hidden else p.days for p in plans}
    courses, robots = 0, set()
    for robot in trend.robots:
        judged = robot.judged
        watched = sum(bool(t.course.use.any()) for t in robot.trends if t.course.role != "job")
        for t in judged:
            per_year = float(t.course.use.sum()) / robot.courses.days * DAYS_PER_YEAR
            limit = alarm_limit(per_year * watched / rate)
            raised = next((n for n, z in zip(t.looked, t.certainty, strict=True) if z > limit), None)
            if raised is None:
                continue
            at = t.course.recorded[int(t.compared[raised - 1])]
            first = t.course.recorded[0]
            assert at is not None and first is not None
            if (at - first).days < healthy[robot.robot]:
                courses += 1
                robots.add(robot.robot)
    return courses, len(robots)


def inside(outcomes: Sequence[FaultOutcome]) -> tuple[int, int]:
    """Return how many sizes of rightly named faults lie within their intervals, and how many there are."""
    sized = [o for o in outcomes if np.isfinite(o.size)]
    return sum(abs(o.size - o.hidden.size) <= o.half_width for o in sized), len(sized)
