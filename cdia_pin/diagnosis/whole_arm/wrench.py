"""Where an arm is touched, and how hard: the link and the force that explain the torques best."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import ExternalWrench, Term
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

OFF = 0.5  # [1], deviation over its limit, above which a joint counts as moved off its course
RIDGE = 1e-3  # [1], added to the scaled normal equations: a link near the base shows one direction of a force only


class Touch(NamedTuple):
    """A force on a link.

    Attributes:
        link: Index of the joint that moves the link.
        force: The force on the arm in base axes [N], shape (3,).
        misfit: Mean square of what it leaves of the torques, over their scale [1].
    """

    link: int
    force: Array
    misfit: float


def located(torque: Array, scale: Array, jacobians: Array) -> Touch:
    """Return the link and the force that explain torques best.

    Args:
        torque: Torques that the arm lacks suddenly [N·m or N], shape (n,).
        scale: Size of a torque that means nothing [N·m or N], shape (n,).
        jacobians: Of the far ends of the links, linear rows first, shape (n, 6, n).
    """
    wanted = torque / scale
    best: Touch | None = None
    for link in range(len(torque)):
        J = (jacobians[link, :3] / scale).T  # (n, 3)
        A = J.T @ J
        force = np.linalg.solve(A + (RIDGE * np.trace(A) + 1e-12) * np.eye(3), J.T @ wanted)
        misfit = float(np.mean((wanted - J @ force) ** 2))
        if best is None or misfit < best.misfit:
            best = Touch(link, force, misfit)
    assert best is not None
    return best


@dataclass(frozen=True)
class Contact:
    """A push, a collision: the link and the force of the moment.

    Attributes:
        since: When it began [s].
        joint: Name of the joint that moves the link.
        force: Force on the arm in base axes [N].
        joints: Joints that it has moved off their course.
    """

    since: float
    joint: str
    force: tuple[float, float, float]
    joints: tuple[str, ...]

    @classmethod
    def of(cls, deviation: Array, limit: Array, robot: RobotModel, q: Array, since: float) -> Contact:
        """Return the contact that explains deviations best.

        Args:
            deviation: Torques that the arm lacks suddenly [N·m or N], shape (n,).
            limit: Their limits [N·m or N], shape (n,).
            robot: The arm, n joints.
            q: Positions [rad or m], shape (n,).
            since: When it began [s].
        """
        touch = located(deviation, limit, robot.link_end_jacobians(q))
        off = np.abs(deviation) > OFF * limit
        joints = tuple(j for j, is_off in zip(robot.joints, off, strict=True) if is_off)
        x, y, z = map(float, np.nan_to_num(touch.force, posinf=0.0, neginf=0.0))
        return cls(since, robot.joints[touch.link], (x, y, z), joints or robot.joints)

    @property
    def term(self) -> Term:
        """The contact as an effect."""
        return Term(ExternalWrench(self.joint), (*self.force, 0.0, 0.0, 0.0))

    @property
    def in_words(self) -> str:
        """Size of the force and its link."""
        return f"{np.linalg.norm(self.force):.0f} N on the link of {self.joint}"
