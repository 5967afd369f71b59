"""The trend of a course: what temperature and load explain of it, and whether it changed beyond that."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

import numpy as np
from numpy.typing import NDArray

from cdia_pin.fleet.alarm_limit import FEWEST_AFTER
from cdia_pin.fleet.course import Course
from cdia_pin.fleet.onset import find_onset
from cdia_pin.fleet.regressors import regressor_columns
from cdia_pin.fleet.robust_fit import robust_fit, usual_deviations
from cdia_pin.fleet.step_search import FEWEST_BEFORE, CourseStep, deviations_to_pass, find_steps
from cdia_pin.regression.intervals import NORMAL_95

Array = NDArray[np.float64]

MOST_LOOKS = 200  # times [1] at which a long course is looked at; each look is a fit
NOTICED_AFTER = 7  # logs [1] after which it is asked how large a change must be to be noticed
DISAGREEMENT = 0.01  # probability [1] below which a few logs do not agree


@dataclass(frozen=True)
class Regressor:
    """What explains a part of a course.

    Attributes:
        name: ``temperature`` or ``load``.
        unit: Its unit.
        slope: Change of the parameter for one unit of it.
        half_width: Half width of the slope's 95 % interval.
    """

    name: str
    unit: str
    slope: float
    half_width: float


@dataclass(frozen=True)
class Alarm:
    """A change of a course that chance does not explain.

    Attributes:
        since: First log after the change.
        since_time: When it was recorded; None where nothing says it.
        raised: Log at which the limit was passed.
        raised_time: When it was recorded.
        size: Change, in the unit of the parameter.
        half_width: Half width of its 95 % interval.
        level: The parameter before, at mean temperature and load.
        certainty: Size over its standard deviation [1].
        lasting: Whether it still holds with all logs.
        logs: Number of logs over which it grew; 1 where it came at once.
    """

    since: str
    since_time: datetime | None
    raised: str
    raised_time: datetime | None
    size: float
    half_width: float
    level: float
    certainty: float
    lasting: bool
    logs: int

    @property
    def is_growth(self) -> bool:
        """Whether it grew over several logs; else it came at once."""
        return self.logs > 1

    @property
    def growth(self) -> float:
        """Change over the level before [1]; NaN where the level is no more than its own uncertainty."""
        return self.size / abs(self.level) if abs(self.level) > 3 * self.half_width else float("nan")


@dataclass(frozen=True, repr=False)
class CourseTrend:
    """A course, what explains it, and whether it changed.

    Attributes:
        course: The course.
        compared: Indices of its logs that are compared, shape (M,).
        regressors: What explains a part of it.
        limit: Limit of the certainty, from the rate of false alarms [1].
        fitted: The value that regressors and change give for each compared log, shape (M,); empty if there are too few.
        level: The parameter at mean temperature and load, before a change if there is one.
        spread: Standard deviation of the value of a usual log, in the unit of the parameter; NaN if unknown.
        half_width: Half width of the 95 % interval of the level.
        alarm: The change; None if there is none.
        certainty: Certainty of a change after each log that was looked at, in order [1].
        looked: Number of compared logs at each of these looks.
    """

    course: Course
    compared: NDArray[np.intp]
    regressors: tuple[Regressor, ...]
    limit: float
    fitted: Array
    level: float
    spread: float
    half_width: float
    alarm: Alarm | None
    certainty: tuple[float, ...] = ()
    looked: tuple[int, ...] = ()

    def __repr__(self) -> str:
        said = "no change" if self.alarm is None else f"changed by {self.alarm.size:.3g}"
        return f"CourseTrend({self.course!r}: {said})"

    @property
    def is_judged(self) -> bool:
        """Whether there are enough logs for an alarm."""
        return len(self.fitted) > 0

    @property
    def noticed(self) -> float:
        """Change that is noticed when it has lasted for a week of daily logs, in the unit of the parameter."""
        return deviations_to_pass(self.limit, NOTICED_AFTER) * self.spread / float(np.sqrt(NOTICED_AFTER))

    @property
    def scatter(self) -> float:
        """Standard deviation of the values of the compared logs, in the unit of the parameter."""
        return float(np.std(self.course.value[self.compared], ddof=1))

    @property
    def agrees(self) -> bool:
        """Whether the values of a few logs agree within their total intervals, at a level of 1 %."""
        from scipy.special import chdtrc

        value, half = self.course.value[self.compared], self.course.half_width[self.compared]
        weight = (NORMAL_95 / np.maximum(half, 1e-300)) ** 2
        mean = np.sum(weight * value) / np.sum(weight)
        return bool(chdtrc(len(value) - 1, float(np.sum(weight * (value - mean) ** 2))) > DISAGREEMENT)


def trend_of(course: Course, limit: float, *, temperature: bool = True) -> CourseTrend:
    """Return the trend of a course.

    Args:
        course: The course; of `with_regressors`, if temperature and load may explain a part of it.
        limit: Limit of the certainty of a change [1].
        temperature: Whether temperature and load may explain a part of it.
    """
    at = np.flatnonzero(course.use)
    value, deviation = course.value[at], course.deviation[at]
    units, columns = regressor_columns(course) if temperature else ({}, np.ones((len(at), 1)))
    looks = _looks(value, deviation, columns)
    if not looks:
        level, half = _mean(value, deviation)
        return CourseTrend(course, at, (), limit, np.zeros(0), level, float("nan"), half, None)
    _, step = looks[-1]
    alarm, fit = None, robust_fit(value, usual_deviations(deviation), columns)
    raised = next((n for n, s in looks if abs(s.z) > limit), None)
    if raised is not None:
        lasts = abs(step.z) > limit
        seen = len(value) if lasts else max(looks, key=lambda look: abs(look[1].z))[0]
        onset = find_onset(value[:seen], deviation[:seen], columns[:seen])
        first, last = int(at[onset.at]), int(at[raised - 1])
        alarm = Alarm(
            course.logs[first],
            course.recorded[first],
            course.logs[last],
            course.recorded[last],
            onset.size,
            NORMAL_95 * onset.deviation,
            float(onset.fit.coefficients[0]),
            max(abs(s.z) for _, s in looks),
            lasts,
            onset.logs,
        )
        fit = onset.fit if lasts else fit
    half_widths = NORMAL_95 * fit.deviations
    regressors = tuple(
        Regressor(name, unit, float(fit.coefficients[k]), float(half_widths[k]))
        for k, (name, unit) in enumerate(units.items(), start=1)
    )
    return CourseTrend(
        course,
        at,
        regressors,
        limit,
        fit.fitted,
        float(fit.coefficients[0]),
        fit.spread,
        float(half_widths[0]),
        alarm,
        tuple(abs(s.z) for _, s in looks),
        tuple(n for n, _ in looks),
    )


def _looks(value: Array, deviation: Array, columns: Array) -> list[tuple[int, CourseStep]]:
    """Return the most likely step after each log, as it was known then, with the number of logs; the last has all."""
    count = len(value)
    first = FEWEST_BEFORE + FEWEST_AFTER
    if count < first:
        return []
    numbers = np.unique(np.linspace(first, count, min(MOST_LOOKS, count - first + 1)).astype(int))
    return [*find_steps(value, deviation, columns, numbers.tolist()).items()]


def _mean(value: Array, deviation: Array) -> tuple[float, float]:
    """Return the weighted mean of a few values, and the half width of its 95 % interval."""
    if not len(value):
        return float("nan"), float("nan")
    weight = 1.0 / (usual_deviations(deviation) ** 2 + 1e-300)
    mean = float(np.sum(weight * value) / np.sum(weight))
    excess = float(np.sum(weight * (value - mean) ** 2)) / max(len(value) - 1, 1)
    return mean, NORMAL_95 * float(np.sqrt(max(excess, 1.0) / np.sum(weight)))
