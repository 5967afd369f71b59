"""The motion in a log, and what can be identified of each joint from it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.joint_units import units_of
from cdia_pin.logs.checks.motion import SmoothedMotion
from cdia_pin.logs.log import Log

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel


def check_excitation(log: Log, robot: RobotModel, motion: SmoothedMotion | None) -> Iterator[Finding]:
    """Report range, speeds, reversals, accelerations and gravity of every joint.

    Args:
        log: The log, for names.
        robot: The robot of the log.
        motion: Signals under the right conventions; None for a log that is too short.

    Yields:
        A finding per joint, and one if no joint moves.
    """
    if motion is None:
        return
    if not motion.moves.any():
        yield Finding(
            Topic.EXCITATION,
            Severity.WARNING,
            "no joint moves: only gravity and offsets can be checked",
            advice="record a motion; 'cdia excite' makes a safe one",
        )
    gravity = np.ptp(robot.gravity(motion.q), axis=0)
    for k, joint in enumerate(log.joints):
        unit, effort_unit = units_of(robot, k)
        if not motion.moves[k]:
            yield Finding(
                Topic.EXCITATION,
                Severity.INFO,
                f"does not move ({np.ptp(motion.q[:, k]):.2g} {unit}): its friction and inertia are not identifiable",
                joint=joint,
                advice="add a log in which it moves",
                value={"moves": False, "range": float(np.ptp(motion.q[:, k]))},
            )
            continue
        v = motion.v[:, k]
        fast = np.abs(v) > 0.05 * np.abs(v).max()
        reversals = int(np.sum(np.diff(np.sign(v[fast])) != 0))
        slow, quick = np.percentile(np.abs(v[fast]), [10, 90])
        forward = float(np.mean(v[fast] > 0))
        value = {
            "moves": True,
            "range": float(np.ptp(motion.q[:, k])),
            "max_speed": float(np.abs(v).max()),
            "speed_p10": float(slow),
            "speed_p90": float(quick),
            "reversals": reversals,
            "share_forward": forward,
            "max_acceleration": float(np.abs(motion.a[:, k]).max()),
            "gravity_range": float(gravity[k]),
        }
        message = (
            f"covers {value['range']:.3g} {unit} at up to {value['max_speed']:.3g} {unit}/s and "
            f"{value['max_acceleration']:.3g} {unit}/s², {reversals} reversal{'s' * (reversals != 1)}, "
            f"gravity changes by {round(gravity[k], 6):.3g} {effort_unit}"
        )
        lacks = []
        if reversals == 0:
            lacks.append("it moves one way only, so friction and a torque offset look alike")
        if quick < 1.5 * slow:
            lacks.append("it has one speed only, so Coulomb and viscous friction look alike")
        yield Finding(
            Topic.EXCITATION,
            Severity.INFO if lacks else Severity.OK,
            "; ".join([message, *lacks]),
            joint=joint,
            advice="add a motion with other speeds in both directions ('cdia excite')" if lacks else "",
            value=value,
        )
