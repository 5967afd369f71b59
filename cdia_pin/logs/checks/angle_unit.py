"""Angles that are degrees by their size, and the search for conventions that begins with their unit."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.logs.checks.conventions import (
    DEGREE,
    LIKELY,
    SEARCH_SAMPLES,
    ConventionChange,
    Conventions,
    ConventionSearch,
    search_conventions,
)
from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.motion import SmoothedMotion
from cdia_pin.logs.log import Log
from cdia_pin.logs.magnitudes import largest_of

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

TOO_FAST = 5.0  # [1], speed over the URDF's limit that no arm reaches; degrees read as rad make 57
USUAL = 90.0  # [%], of the samples have less than the speed that counts, so that single wild samples do not


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
    most = largest_of(log.position)
    turns = np.maximum(2 * np.pi, np.where(limited, limits.upper, 0.0))
    beyond = revolute & (most > 1.2 * turns)
    for k in np.flatnonzero(beyond & ~limited).tolist():
        speed = np.abs(np.diff(log.position[:, k]) / np.diff(log.time))
        beyond[k] = np.percentile(speed, USUAL) > TOO_FAST * limits.velocity[k]
    if not beyond.any():
        return None
    as_degrees = log.position * DEGREE
    fits = (as_degrees > limits.lower - 0.01) & (as_degrees < limits.upper + 0.01)
    return float(most[beyond].max()) if fits[:, revolute].all() else None
