"""The weight that each joint of an arm carries, by which effects against gravity are judged."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

POSTURES = 100  # postures [1] over the range of the joints; their largest torque is near the largest of all
LOADED = (
    0.1  # gravity torque over that of the most loaded joint [1]; below it tools and cables outweigh the links
)


@lru_cache(maxsize=32)
def largest_weight(robot: RobotModel) -> Array:
    """Return the largest gravity torque of each joint over its range [N·m or N], shape (n,); read only.

    Args:
        robot: The arm.
    """
    lower, upper = robot.limits.usual_range(robot.is_prismatic)
    q = np.random.default_rng(0).uniform(lower, upper, (POSTURES, robot.n))
    weight = np.abs(robot.gravity(q)).max(axis=0)
    weight.setflags(write=False)
    return np.asarray(weight)


def weighted_joints(robot: RobotModel) -> tuple[str, ...]:
    """Return the revolute joints that gravity loads as the arm moves.

    Args:
        robot: The arm.
    """
    weight = largest_weight(robot)
    loads = (weight > LOADED * weight.max()) & (weight > 0) & ~robot.is_prismatic
    return tuple(j for j, is_loaded in zip(robot.joints, loads, strict=True) if is_loaded)
