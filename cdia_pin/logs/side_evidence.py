r"""Evidence for the side of the gear on which a torque was measured.

Of each joint the torque is fitted by the inertial parameters of all links, an offset, and friction:

.. math:: \tau_j \approx Y_j \pi + c_j + \alpha_j\, \mathrm{sgn}\, \dot q_j + \beta_j\, \dot q_j

The motor drives the friction of its gear. So a torque from its current jumps by 2 α at each reversal, and α is some
percent of the torque that the gear is made for. A sensor behind the gear sees the bearings and cables of the link only,
far less but not nothing, and its zero is its own. A torque without any friction is that of a simulation, and tells
nothing. Standard errors follow from blocks of time that are left out in turn, because what the model lacks
repeats with the posture, not with the sample.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.jackknife import jackknife_error
from cdia_pin.logs.torque_side import TorqueSide

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# Dry friction over the torque limit of the joint [1]. Strain-wave gears of measured arms take 4 to 7 %, sensors behind
# such gears show 0.1 to 0.6 %. One joint above 1 % rules such a sensor out: to take friction away from an arm that has
# it is worse than to look for friction that cannot be there.
LEAST_OF_A_GEAR, MOST_OF_A_LINK, USUAL_OF_A_LINK = 0.02, 0.01, 0.006
# Torque limit over the weight that the most loaded joint carries [1]. Arms have 2 to 5; more is a number that somebody
# put there because a URDF asks for one.
HIGHEST_LIMIT = 10.0
# Rigid-body torque of the URDF in the efforts [1]. Behind the gear it is 1 but for what the URDF lacks; far less of it
# is a current, or another unit, and limits in N·m tell nothing of its friction.
LEAST_SCALE = 0.5
SURELY = 3.0  # standard errors from zero [1], because one of many joints exceeds two by chance
MOST = 0.75  # share of the joints that must agree [1]
LEAST_SURE = 0.5  # share of the joints that must show friction at all [1]
FEWEST_JOINTS = 4  # joints [1] that must be judged; of fewer, most is one or two
BLOCKS = 16  # parts of the log [1] that are left out in turn
RIDGE = 1e-3  # of the inertial columns in units of their RMS [1]: many of them repeat each other
SLOW = 0.02  # [rad/s or m/s], below it friction is whatever keeps the joint where it is
FEWEST_SAMPLES = 150  # samples [1] in motion; fewer do not determine the inertial parameters of several links


@dataclass(frozen=True)
class JointFriction:
    """What a torque shows of friction and zero of a joint, with standard errors.

    Attributes:
        dry: α, half the jump at a reversal [N·m or N].
        dry_error: Its standard error [N·m or N].
        viscous: β [N·m·s/rad or N·s/m].
        viscous_error: Its standard error [N·m·s/rad or N·s/m].
        offset: c [N·m or N].
        offset_error: Its standard error [N·m or N].
        limit: Torque limit of the joint [N·m or N]; infinite if the URDF states none.
    """

    dry: float
    dry_error: float
    viscous: float
    viscous_error: float
    offset: float
    offset_error: float
    limit: float

    @property
    def is_of_a_gear(self) -> bool:
        """True if dry friction is surely as large as that of a motor's gear."""
        return self.dry - 2 * self.dry_error > LEAST_OF_A_GEAR * self.limit

    @property
    def is_behind_a_gear(self) -> bool:
        """True if dry friction surely is too small for that of a gear: it is measured, or bounded."""
        usual = USUAL_OF_A_LINK * self.limit
        return (self.dry < usual and self.is_sure) or self.dry + 2 * self.dry_error < usual

    @property
    def is_too_large_for_a_link(self) -> bool:
        """True if dry friction is larger than a sensor behind the gear sees."""
        return self.is_sure and self.dry > MOST_OF_A_LINK * self.limit

    @property
    def is_sure(self) -> bool:
        """True if dry friction surely differs from zero."""
        return self.dry > SURELY * self.dry_error


@dataclass(frozen=True)
class SideEvidence:
    """What a torque shows of the side of its sensor.

    Attributes:
        joints: Friction and zero of each joint that moves enough, by name.
        scale: Gain of the URDF's rigid-body torque in the torque, over these joints [1].
    """

    joints: Mapping[str, JointFriction]
    scale: float = 1.0

    @property
    def _judged(self) -> list[JointFriction]:
        return [f for f in self.joints.values() if np.isfinite(f.limit)]

    @property
    def shows_friction(self) -> bool:
        """True if a joint surely shows dry friction."""
        return any(f.is_sure for f in self._judged)

    @property
    def is_too_large_for_a_link(self) -> bool:
        """True if a joint surely shows more dry friction than a sensor behind the gear usually sees."""
        return self.scale >= LEAST_SCALE and any(f.is_too_large_for_a_link for f in self._judged)

    @property
    def side(self) -> TorqueSide:
        """The side on which most joints agree; unknown if they do not, or if too few can be judged."""
        judged = self._judged
        if len(judged) < FEWEST_JOINTS:
            return TorqueSide.UNKNOWN
        if np.mean([f.is_of_a_gear for f in judged]) >= MOST:
            return TorqueSide.MOTOR
        large = any(f.is_too_large_for_a_link for f in judged)
        some = np.mean([f.is_sure for f in judged]) >= LEAST_SURE  # a simulation may have none at all
        small = np.mean([f.is_behind_a_gear for f in judged]) >= MOST
        if small and some and not large and self.scale >= LEAST_SCALE:
            return TorqueSide.LINK
        return TorqueSide.UNKNOWN


def side_evidence(robot: RobotModel, q: Array, v: Array, a: Array, effort: Array) -> SideEvidence:
    """Measure friction and zero of each joint that moves.

    Args:
        robot: The arm, n joints.
        q: Positions, filtered without lag [rad or m], shape (N, n).
        v: Velocities [rad/s or m/s], shape (N, n).
        a: Accelerations [rad/s² or m/s²], shape (N, n).
        effort: Torques with the same filter [N·m or N], shape (N, n).
    """
    regressor = robot.torque_regressor(q, v, a)
    nominal = regressor @ robot.inertial_parameters.reshape(-1)
    limits = _limits(robot)
    found = {}
    seen, whole = 0.0, 0.0
    for j, joint in enumerate(robot.joints):
        moving = np.abs(v[:, j]) > SLOW
        there, back = np.sum(v[moving, j] > 0), np.sum(v[moving, j] < 0)
        if moving.sum() < FEWEST_SAMPLES or min(there, back) < FEWEST_SAMPLES / 4:
            continue
        own = np.column_stack([np.sign(v[moving, j]), v[moving, j], np.ones(moving.sum())])
        value, error = _fitted(own, regressor[moving, j], effort[moving, j])
        dry, viscous, offset = zip(value.tolist(), error.tolist(), strict=True)
        found[joint] = JointFriction(*dry, *viscous, *offset, float(limits[j]))
        rigid = nominal[moving, j] - own @ np.linalg.lstsq(own, nominal[moving, j], rcond=None)[0]
        seen, whole = seen + float(rigid @ effort[moving, j]), whole + float(rigid @ rigid)
    return SideEvidence(found, seen / whole if whole > 0 else 1.0)


def _limits(robot: RobotModel) -> Array:
    """Return the torque limit of each joint [N·m or N], infinite where it is none, shape (n,)."""
    from cdia_pin.effects.weight import largest_weight  # brings pinocchio, which readers of logs do not need

    weight = largest_weight(robot)
    limits = np.where(robot.limits.effort > 0, robot.limits.effort, np.inf)
    loaded = int(np.argmax(weight))
    return limits if limits[loaded] <= HIGHEST_LIMIT * weight[loaded] else np.full(robot.n, np.inf)


def _fitted(own: Array, regressor: Array, effort: Array) -> tuple[Array, Array]:
    """Return the parameters of the columns of friction and zero, and their standard errors, shape (3,) each."""
    columns = np.column_stack([own, regressor])
    size = np.sqrt(np.mean(columns**2, axis=0))
    seen = size > 1e-9 * size.max()
    columns, size = columns[:, seen] / size[seen], size[: own.shape[1]]
    parts = np.array_split(np.arange(len(effort)), BLOCKS)
    gram = np.array([columns[p].T @ columns[p] for p in parts])
    moment = np.array([columns[p].T @ effort[p] for p in parts])
    prior = RIDGE * len(effort) * np.eye(columns.shape[1])
    prior[:3, :3] = 0.0
    whole = np.linalg.solve(gram.sum(axis=0) + prior, moment.sum(axis=0))[:3]
    left_out = np.linalg.solve(gram.sum(axis=0) + prior - gram, (moment.sum(axis=0) - moment)[..., None])
    return whole / size, jackknife_error(left_out[:, :3, 0]) / size
