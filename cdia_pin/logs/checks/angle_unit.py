"""Angles that are degrees by their size, and the search for conventions that begins with their unit."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.angle_size import beyond_reach, limited
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
    beyond = _angle_out_of_reach(log, robot)
    gain = next((t.gain for t in search.rest if t.kind is ConventionChange.DEGREES), 0.0)
    # A joint without limits may turn far and fast: the torques must speak for degrees, or else only not against them.
    least = -LIKELY if (beyond & limited(robot)).any() else LIKELY
    if not beyond.any() or search.conventions.angle != 1.0 or gain <= least:
        return search, []
    largest = float(largest_of(log.position)[beyond].max())
    degrees = replace(Conventions.assumed(robot.n), angle=DEGREE)
    finding = Finding(
        Topic.UNITS,
        Severity.ERROR,
        f"positions up to {largest:.4g} are several turns as rad, within limits as degrees",
        advice="--convert angle=deg",
        value={"largest": largest},
    )
    return search_conventions(motion, robot, degrees), [finding]


def _angle_out_of_reach(log: Log, robot: RobotModel) -> NDArray[np.bool_]:
    """Return the joints beyond their reach in rad; none unless all are within the URDF's limits as degrees."""
    limits, as_degrees = robot.limits, log.position * DEGREE
    fits = (as_degrees > limits.lower - 0.01) & (as_degrees < limits.upper + 0.01)
    beyond = beyond_reach(log.position, log.time, robot)
    return beyond if fits[:, ~robot.is_prismatic].all() else np.zeros_like(beyond)
