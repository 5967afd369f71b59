"""The motion in a log, and what can be identified of each joint from it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.joint_units import units_of
from cdia_pin.logs.checks.motion import SmoothedMotion
from cdia_pin.logs.log import Log
from cdia_pin.logs.reversals import is_fast, reversals
from cdia_pin.phrases import counted

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel


def check_excitation(log: Log, robot: RobotModel, motion: SmoothedMotion | None) -> Iterator[Finding]:
    """Report range, speeds, reversals, accelerations and gravity of every joint.

    Args:
        log: The log, for names.
        robot: The robot of the log.
        motion: Signals under the right conventions; None for a log that is too short.

    Yields:
        A finding per joint, and one if no joint moves, or if all move in step.
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
    yield from _in_step(motion)
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
        fast, turns = is_fast(v), reversals(v)
        slow, quick = np.percentile(np.abs(v[fast]), [10, 90])
        forward = float(np.mean(v[fast] > 0))
        value = {
            "moves": True,
            "range": float(np.ptp(motion.q[:, k])),
            "max_speed": float(np.abs(v).max()),
            "speed_p10": float(slow),
            "speed_p90": float(quick),
            "reversals": turns,
            "share_forward": forward,
            "max_acceleration": float(np.abs(motion.a[:, k]).max()),
            "gravity_range": float(gravity[k]),
        }
        message = (
            f"covers {value['range']:.3g} {unit} at up to {value['max_speed']:.3g} {unit}/s and "
            f"{value['max_acceleration']:.3g} {unit}/s², {counted(turns, 'reversal')}, "
            f"gravity changes by {round(gravity[k], 6):.3g} {effort_unit}"
        )
        lacks = []
        if turns == 0:
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


def _in_step(motion: SmoothedMotion) -> Iterator[Finding]:
    """Report joints that all follow one course, so that every effect of one looks like an effect of another."""
    if motion.is_in_step:
        share = motion.common_course
        yield Finding(
            Topic.EXCITATION,
            Severity.WARNING,
            f"the joints move in step ({share:.1%} of their speeds is one common course): a payload, links and what "
            "depends on the position of other joints look alike",
            advice="add a motion in which the joints move at different times or speeds; 'cdia excite' makes one",
            value={"in_step": share},
        )
