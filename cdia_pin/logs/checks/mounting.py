"""How the base stands: gravity in another direction than the URDF's explains the efforts better."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.arm_fit import arm_fit, loaded_fit, scaled_by_joint, scaled_fit
from cdia_pin.logs.checks.motion import SmoothedMotion

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

SAMPLES = 300  # [samples], many for three parameters
TURNED = 20.0  # [°], least turn of gravity that counts: measured arms with their own URDF show up to 6°
MOST_SIZE = (
    2.5  # [1], fitted gravity over the URDF's, or its inverse: wrong masses and a payload give up to 1.9
)
AHEAD_OF_GAIN = (
    1.0  # [1], least lead of a turned gravity over one gain in misfit: a factor of e in unexplained shares
)
# A body on the tool and a gain of each joint have more parameters. On an arm with three reversed efforts a turned
# gravity is 5 behind gains; turned by 23 to 180°, a UR10e is 10 ahead of them to 0.3 behind.
MOST_BEHIND = (
    1.0  # [1], misfit by which a turned gravity may be behind these: a factor of e, between 0.3 and 5
)


def gravity_elsewhere(motion: SmoothedMotion, robot: RobotModel) -> tuple[float, float, float] | None:
    """Fit the gravity vector, and return it where it points elsewhere and nothing more usual explains that.

    Args:
        motion: Signals in SI units.
        robot: The robot of the log.

    Returns:
        Gravity in the base, with the size of the URDF's [m/s²]; None if the URDF's direction may be right.
    """
    expected = robot.gravity_vector
    size = float(np.linalg.norm(expected))
    if size == 0.0 or not motion.moves.any():
        return None
    motion = motion.thin(SAMPLES)
    turned = arm_fit(robot, motion, robot.gravity_regressor(motion.q))
    gravity = expected + turned.shared
    found = float(np.linalg.norm(gravity))
    if not 1 / MOST_SIZE < found / size < MOST_SIZE or turn_of(gravity, expected) < TURNED:
        return None
    if turned.misfit >= scaled_fit(robot, motion).misfit - AHEAD_OF_GAIN:
        return None
    more_usual = min(fit(robot, motion).misfit for fit in (loaded_fit, scaled_by_joint))
    if turned.misfit > more_usual + MOST_BEHIND:
        return None
    x, y, z = (gravity * (size / found)).tolist()
    return x, y, z


def turn_of(gravity: Array, expected: Array) -> float:
    """Compute the angle between two gravity vectors [°].

    Args:
        gravity: One vector [m/s²], shape (3,).
        expected: The other one [m/s²], shape (3,).
    """
    cosine = float(gravity @ expected) / float(np.linalg.norm(gravity) * np.linalg.norm(expected))
    return float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def upright(gravity: Array) -> tuple[float, float]:
    """Compute roll and pitch of a base in a world whose gravity is along -z [rad], the yaw being 0.

    Args:
        gravity: Gravity in the base [m/s²], shape (3,).
    """
    x, y, z = (gravity / np.linalg.norm(gravity)).tolist()
    return float(np.arctan2(-y, -z)), float(np.arcsin(np.clip(x, -1.0, 1.0)))
