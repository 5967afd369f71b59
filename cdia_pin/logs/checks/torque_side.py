"""The check of the side of the gear on which a log's torque was measured."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.logs.checks.finding import Finding, Severity, Topic
from cdia_pin.logs.checks.motion import SmoothedMotion
from cdia_pin.logs.log import Log
from cdia_pin.logs.side_evidence import LEAST_SCALE, SideEvidence, side_evidence
from cdia_pin.logs.torque_side import TorqueSide

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

MEANS = {
    TorqueSide.MOTOR: "the torque is that of the motor: it drives the friction of the gear and the rotor",
    TorqueSide.LINK: "the torque is measured behind the gear: it has a zero of its own, and shows neither friction of "
    "the motor nor its rotor",
}
OTHER = {TorqueSide.MOTOR: TorqueSide.LINK, TorqueSide.LINK: TorqueSide.MOTOR}


def check_torque_side(log: Log, robot: RobotModel, motion: SmoothedMotion) -> Iterator[Finding]:
    """Tell on which side of the gear the torque was measured, and by what.

    Args:
        log: The log, for names and what is known of it.
        robot: The robot of the log.
        motion: Signals under the right conventions.

    Yields:
        One finding.
    """
    evidence = side_evidence(robot, motion.q, motion.v, motion.a, motion.effort)
    value: dict[str, object] = {
        "measured": str(evidence.side),
        "shows_friction": evidence.shows_friction,
        **{joint: asdict(friction) for joint, friction in evidence.joints.items()},
    }
    said = _said(evidence)
    if log.side_of_format and evidence.is_too_large_for_a_link:
        value["side"] = str(TorqueSide.UNKNOWN)
        yield Finding(
            Topic.TORQUE_SIDE,
            Severity.INFO,
            f"the format says that the torque is measured behind the gear, but {said}, more than such a sensor "
            "usually sees: friction and rotors are looked for",
            advice="--torque-side link keeps them out",
            value=value,
        )
    elif log.torque_side is not TorqueSide.UNKNOWN:
        value["side"] = str(log.torque_side)
        odd = evidence.side is OTHER[log.torque_side]
        source = "the log holds currents, its format states it, or it was said so"
        doubt = f", but it looks like the {evidence.side} side: {said}" if odd else ""
        severity = Severity.WARNING if odd else Severity.OK
        yield Finding(Topic.TORQUE_SIDE, severity, f"{MEANS[log.torque_side]} ({source}){doubt}", value=value)
    elif evidence.side is not TorqueSide.UNKNOWN:
        value["side"] = str(evidence.side)
        yield Finding(
            Topic.TORQUE_SIDE,
            Severity.OK,
            f"{MEANS[evidence.side]}: {said}",
            advice=f"if that is wrong, --torque-side {OTHER[evidence.side]}",
            value=value,
        )
    else:
        value["side"] = str(TorqueSide.UNKNOWN)
        yield Finding(
            Topic.TORQUE_SIDE,
            Severity.INFO,
            f"cannot tell on which side of the gear the torque was measured{': ' if said else ''}{said}",
            advice="if it is a sensor behind the gear, --torque-side link keeps friction of the motor out",
            value=value,
        )


def _said(evidence: SideEvidence) -> str:
    """Return the range of dry friction over the torque limits, in words; empty if no joint can be judged."""
    judged = [f for f in evidence.joints.values() if np.isfinite(f.limit)]
    if not judged:
        return ""
    if evidence.scale < LEAST_SCALE:
        return (
            f"the efforts are {evidence.scale:.2g} of the URDF's torque, and its limits tell nothing of them"
        )
    if not evidence.shows_friction:
        return "no jump at reversals shows dry friction (gears take 4 to 7 % of the torque limits)"
    shares = [max(100 * f.dry / f.limit, 0.0) for f in judged]
    least, most = (f"{share:.2g}" for share in (min(shares), max(shares)))
    size = most if least == most else f"{least} to {most}" if min(shares) > 0 else f"up to {most}"
    return f"the jump at reversals shows dry friction of {size} % of the torque limits (gears take 4 to 7 %)"
