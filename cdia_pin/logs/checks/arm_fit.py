r"""The efforts of a log explained by the rigid-body torque of an arm as it is.

.. math:: \tau_j \approx (M \ddot q + \mathrm{nle})_j + \beta_v \dot q_j + \beta_c\,\mathrm{sgn}\,\dot q_j
          + I_j \ddot q_j + c + \sum_i x_{ji} \theta_i

The rigid-body torque has no gain here, so that its size counts; θ are coefficients that all joints share.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.fit import misfit
from cdia_pin.logs.checks.motion import SmoothedMotion, sign_of

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

BODY = 10  # inertial parameters of a body


@dataclass(frozen=True)
class ArmFit:
    """How an arm explains the efforts of a log.

    Attributes:
        name: Name of the arm.
        share: Unexplained share of the variance of each effort [1], shape (n,); NaN for joints that do not move.
        shared: Coefficients that all joints share, shape (k,).
    """

    name: str
    share: Array
    shared: Array

    @property
    def misfit(self) -> float:
        """Sum of the logarithms of the shares [1]."""
        return misfit(self.share)

    @property
    def mean(self) -> float:
        """Mean of the shares [1]; 1 if no joint moves."""
        moving = self.share[np.isfinite(self.share)]
        return float(np.mean(moving)) if moving.size else 1.0


def arm_fit(robot: RobotModel, motion: SmoothedMotion, shared: Array | None = None) -> ArmFit:
    """Explain efforts by the rigid-body torque of an arm, and friction, rotor inertia and offset of each joint.

    Args:
        robot: The arm; the joints of the motion are taken in its order.
        motion: Signals in SI units.
        shared: Columns whose coefficients all joints share [N·m or N per unit], shape (N, n, k).

    Returns:
        The unexplained shares.
    """
    return _fit(robot, motion, motion.effort - robot.inverse_dynamics(motion.q, motion.v, motion.a), shared)


def friction_fit(robot: RobotModel, motion: SmoothedMotion) -> ArmFit:
    """Explain efforts by friction, rotor inertia and offset of each joint alone, as if the links had no mass.

    Args:
        robot: The arm, for its name and joints.
        motion: Signals in SI units.
    """
    return _fit(robot, motion, motion.effort)


def _fit(robot: RobotModel, motion: SmoothedMotion, missing: Array, shared: Array | None = None) -> ArmFit:
    size = np.maximum(motion.effort.std(axis=0), 1e-12)
    moving = np.flatnonzero(motion.moves).tolist()
    left, columns, coefficients = {}, [], np.zeros(0)
    for j in moving:
        own = np.column_stack(
            [np.ones(len(motion.time)), motion.v[:, j], sign_of(motion.v[:, j]), motion.a[:, j]]
        )
        basis, _ = np.linalg.qr(own / np.maximum(np.linalg.norm(own, axis=0), 1e-12))
        left[j] = _outside(basis, missing[:, j]) / size[j]
        if shared is not None:
            columns.append(_outside(basis, shared[:, j]) / size[j])
    if columns:
        x, y = np.vstack(columns), np.concatenate([left[j] for j in moving])
        coefficients = np.linalg.lstsq(x, y, rcond=1e-6)[0]
        rest = np.split(y - x @ coefficients, len(moving))
        left = dict(zip(moving, rest, strict=True))
    share = np.full(robot.n, np.nan)
    for j, e in left.items():
        share[j] = np.mean(e**2)
    return ArmFit(robot.name, share, coefficients)


def loaded_fit(robot: RobotModel, motion: SmoothedMotion) -> ArmFit:
    """Explain efforts by the arm with any body on its tool.

    Args:
        robot: The arm.
        motion: Signals in SI units.
    """
    return arm_fit(robot, motion, robot.torque_regressor(motion.q, motion.v, motion.a)[:, :, -BODY:])


def scaled_fit(robot: RobotModel, motion: SmoothedMotion) -> ArmFit:
    """Explain efforts by the arm with one gain for all joints; its one shared coefficient is the gain less 1.

    Args:
        robot: The arm.
        motion: Signals in SI units.
    """
    return arm_fit(robot, motion, robot.inverse_dynamics(motion.q, motion.v, motion.a)[:, :, None])


def scaled_by_joint(robot: RobotModel, motion: SmoothedMotion) -> ArmFit:
    """Explain efforts by the arm with a gain for each joint, of either sign; its shared coefficients are these less 1.

    Args:
        robot: The arm.
        motion: Signals in SI units.
    """
    rigid = robot.inverse_dynamics(motion.q, motion.v, motion.a)
    return arm_fit(robot, motion, rigid[:, :, None] * np.eye(robot.n))


def _outside(basis: Array, signal: Array) -> Array:
    return np.asarray(signal - basis @ (basis.T @ signal))
