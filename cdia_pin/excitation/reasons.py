"""Why no motion tells two effects apart, in words."""

from __future__ import annotations

import numpy as np

from cdia_pin.effects.body import Body
from cdia_pin.excitation.information import Information
from cdia_pin.excitation.sides import Side
from cdia_pin.regression.experiment import Experiment

WEIGHTLESS = 1e-9  # share of the largest joint's gravity torque below which gravity does not load a joint


def has_torque(side: Side, everything: Information) -> bool:
    """Tell whether an explanation gives any torque on any motion."""
    at = everything.columns(side.shapes[0])
    return bool(everything.gram[np.ix_(at, at)].any())


def why_silent(side: Side, reference: Experiment) -> str:
    """Return why an explanation without a torque has none."""
    return f"{side.label} has no torque on any motion of this arm{_upright(side, reference)}"


def why_alike(one: Side, two: Side, reference: Experiment) -> str:
    """Return why two explanations that differ on no motion do not.

    Args:
        one: One explanation.
        two: The other.
        reference: Motions over all of the limits.
    """
    bodies = [e for side in (one, two) for e in side.effects if isinstance(e, Body)]
    if len(bodies) == 2 and bodies[0].carrier(reference.robot) == bodies[1].carrier(reference.robot):
        return "both are a body on the same link: repeat a log with the tool taken off"
    return f"whatever {one.label} does, {two.label} can do as well{_upright(one, reference)}"


def _upright(side: Side, reference: Experiment) -> str:
    """Return the remark that gravity does not load a joint, if that is so."""
    robot = reference.robot
    q = np.vstack([s.state.q for s in reference.segments])
    load = np.abs(robot.gravity(q)).max(axis=0)
    upright = [
        j for e in side.effects for j in e.scope if load[robot.joint_index(j)] <= WEIGHTLESS * load.max()
    ]
    if not upright:
        return ""
    return f" (gravity does not load {', '.join(dict.fromkeys(upright))}, whose axis is along it)"
