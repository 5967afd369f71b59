"""Temperature and load as regressors of a course, and the logs that say nothing of them.

A regressor has a value in each log that is compared. If most logs have one, the others are left out: a value that is
guessed for them would be an error of their parameters, and a course without the regressor has the scatter of the
temperature. If half of the logs or more lack it, too much would be lost, and the course goes without it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.fleet.alarm_limit import FEWEST_AFTER
from cdia_pin.fleet.course import Course
from cdia_pin.fleet.step_search import FEWEST_BEFORE

Array = NDArray[np.float64]

TEMPERATURE, LOAD = "temperature", "load"
LEAST_WARMING = 1.0  # [K], range of temperature below which it explains nothing: drives report whole degrees
LEAST_LOADING = 0.05  # range of the load over its mean [1], below which it explains nothing
LOGS_PER_REGRESSOR = 4  # logs [1] that each regressor needs besides those around a change
LACKING = 0.5  # share of the logs [1] that may lack a regressor; with more it is not used


def with_regressors(course: Course) -> Course:
    """Return a course in which the logs that lack a regressor of most others are not compared.

    Args:
        course: The course.
    """
    used = 0
    for name in (TEMPERATURE, LOAD):
        known = course.use & np.isfinite(_signal(course, name))
        if known.sum() <= (1 - LACKING) * course.use.sum():
            continue
        if _explains(name, _signal(course, name)[known], used):
            used += 1
            why = f"it lacks the {name} that most logs have"
            lacking = course.use & ~known
            reasons = zip(course.not_comparable, lacking, strict=True)
            course = replace(course, not_comparable=tuple(why if left else old for old, left in reasons))
    return course


def regressor_columns(course: Course) -> tuple[dict[str, str], Array]:
    """Return the units of the regressors by name, and their columns after a constant, centred, shape (M, p).

    Args:
        course: A course of `with_regressors` with M logs that are compared.
    """
    columns: list[Array] = [np.ones(int(course.use.sum()))]
    units: dict[str, str] = {}
    effort = "N" if course.unit.startswith("N") and "m" not in course.unit else "N·m"
    for name, unit in ((TEMPERATURE, "K"), (LOAD, effort)):
        signal = _signal(course, name)[course.use]
        if np.isfinite(signal).all() and _explains(name, signal, len(units)):
            columns.append(signal - np.mean(signal))
            units[name] = unit
    return units, np.column_stack(columns)


def _signal(course: Course, name: str) -> Array:
    return course.temperature if name == TEMPERATURE else course.load


def _explains(name: str, signal: Array, others: int) -> bool:
    """Tell whether there are enough logs for a regressor beside some others, and whether it varies."""
    if len(signal) < FEWEST_BEFORE + FEWEST_AFTER + LOGS_PER_REGRESSOR * (others + 1):
        return False
    least = LEAST_WARMING if name == TEMPERATURE else LEAST_LOADING * abs(float(np.mean(signal)))
    return float(np.ptp(signal)) > least
