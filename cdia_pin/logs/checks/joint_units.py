"""Units of a joint's position and effort, for messages."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel


def units_of(robot: RobotModel, joint: int) -> tuple[str, str]:
    """Return the units of position and effort of a joint, such as ``("rad", "N·m")``.

    Args:
        robot: The robot.
        joint: Index of the joint.
    """
    return ("m", "N") if robot.is_prismatic[joint] else ("rad", "N·m")
