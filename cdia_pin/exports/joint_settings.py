"""What settings for the joints of a simulator have in common: a number for every joint, and no bodies."""

from __future__ import annotations

from collections.abc import Mapping

from cdia_pin.dynamics.simple_terms import Quantity
from cdia_pin.robot.model import RobotModel

BODIES_ELSEWHERE = dict.fromkeys((Quantity.BODIES, Quantity.PAYLOAD), "belongs in the corrected URDF, --urdf")


def for_every_joint(numbers: Mapping[str, float], robot: RobotModel) -> dict[str, float]:
    """Return a number for every joint of a robot; zero where none is given.

    Args:
        numbers: By joint.
        robot: The robot.
    """
    return {joint: numbers.get(joint, 0.0) for joint in robot.joints}
