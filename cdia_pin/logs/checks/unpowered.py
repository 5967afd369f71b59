"""Joints that move although their effort is hardly any: the drive is off, or its torque is not what was recorded.

Friction, other joints and gravity move such a joint. What is read there is the noise of a drive at rest, and it says
nothing of signs, of gravity or of the side of a sensor. Efforts in other units are small on all joints that carry
weight. So most of the other joints that need as much torque must show that the unit is right.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdia_pin.logs.checks.conventions import ConventionChange, ConventionSearch
from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.fit import physical_columns
from cdia_pin.logs.checks.joint_units import units_of
from cdia_pin.logs.checks.motion import SmoothedMotion
from cdia_pin.logs.log import Log

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# Standard deviation of an effort over that of the URDF's torque [1], below which the drive does not move the joint. It
# is 0.01 to 0.26 in eleven logs of a double pendulum of which one drive is off, and 0.33 and more on the joints of 90
# other measured logs in N·m: 0.27 and 0.32 decide alike.
LEAST_EFFORT = 0.3  # [1]
# The same of a joint that shows the unit to be right; 0.56 to 2.2 in these logs.
USUAL_EFFORT = (0.5, 2.5)  # [1]
# URDF's torque of another joint over that of the joint [1], from which it tells the unit. Motor currents in A are 0.05
# to 0.3 of the torque of joints that carry weight, and of the size of the torque of one that carries none.
ALIKE = 0.5  # [1]
MOST = 0.5  # share of these joints [1] that must be of the usual size
ORDERS = {ConventionChange.ORDER, ConventionChange.EFFORT_ORDER}


def unpowered(motion: SmoothedMotion, robot: RobotModel, search: ConventionSearch) -> NDArray[np.bool_]:
    """Return True for joints that move although their effort is hardly any, shape (n,).

    Not those that may hold the effort of another joint.

    Args:
        motion: Signals as logged.
        robot: The robot of the log.
        search: The search for other conventions of that log.
    """
    changed = {k for trial, _ in search.steps if trial.kind in ORDERS for k in trial.joints}
    if search.possible is not None and search.possible.kind in ORDERS:
        changed.update(search.possible.joints)
    columns = physical_columns(motion, robot)
    needed = np.maximum((columns[:, :, 0] + columns[:, :, 1]).std(axis=1), 1e-12)
    share = motion.effort.std(axis=0) / needed
    low, high = USUAL_EFFORT
    usual = (low <= share) & (share <= high)
    out = np.zeros(robot.n, dtype=bool)
    for k in set(np.flatnonzero(motion.moves & (share < LEAST_EFFORT)).tolist()) - changed:
        others = motion.moves & (needed >= ALIKE * needed[k])
        others[k] = False
        out[k] = others.any() and usual[others].mean() > MOST
    return out


def check_unpowered(log: Log, robot: RobotModel, joints: NDArray[np.bool_]) -> Iterator[Finding]:
    """Report joints that move although their effort is hardly any.

    Args:
        log: The log.
        robot: Its robot.
        joints: True for these joints, shape (n,).

    Yields:
        A finding per joint.
    """
    for k in np.flatnonzero(joints).tolist():
        _, unit = units_of(robot, k)
        size = float(log.effort[:, k].std())
        yield Finding(
            Topic.EFFORT_KIND,
            Severity.WARNING,
            f"its effort varies by {size:.2g} {unit} only, far less than the URDF needs for this motion: the drive is "
            "off, or the effort is not the torque of this joint; its sign and unit are not checked",
            joint=log.joints[k],
            advice="if its drive was off, that is all right; otherwise record the effort of this joint",
            value={"effort_std": size},
        )
