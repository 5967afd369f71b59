"""Checks of a robot description: doubtful values are reported at loading and never corrected silently."""

from __future__ import annotations

from collections.abc import Mapping

import pinocchio as pin

from cdia_pin.errors import RobotError
from cdia_pin.robot.inertia import physical_margin
from cdia_pin.robot.joints import LockedJoint
from cdia_pin.robot.urdf import Urdf

# [1], share of the sum of the principal moments. URDFs print five or six digits: a flat or thin body may break
# the triangle inequality by that much.
ROUNDING = 1e-4


def description_warnings(urdf: Urdf, model: pin.Model, held: Mapping[str, LockedJoint]) -> list[str]:
    """List doubtful inertias, ranges and mimic joints of the bodies that move.

    Args:
        urdf: The description.
        model: Pinocchio's model of it, with the locked joints fixed.
        held: The locked joints, by name.

    Returns:
        One line per doubt; empty for a sound description.

    Raises:
        RobotError: If no moving body has any mass.
    """
    if not any(model.inertias[i].mass > 0 for i in range(1, model.njoints)):
        raise RobotError(
            f"{urdf.path}: no moving link has a mass; <inertial> is needed, a URDF for drawing is not enough"
        )
    return [*_unphysical(urdf, model), *_massless(model), *_ranges(model), *_lost_mimics(urdf, model)]


def _unphysical(urdf: Urdf, model: pin.Model) -> list[str]:
    """Find moving links whose inertia is not physically consistent [Wensing2018]_."""
    out = []
    moving = {f.name for f in model.frames if f.type == pin.FrameType.BODY and f.parentJoint > 0}
    for link in urdf.links:
        parameters = urdf.link_parameters(link)
        if parameters is None or link not in moving:
            continue
        margin = float(physical_margin(parameters))
        if parameters[0] < 0:
            out.append(f"link '{link}': negative mass {parameters[0]:g} kg")
        elif margin < -ROUNDING:
            out.append(
                f"link '{link}': no body has this inertia (it breaks the triangle inequality of the principal "
                f"moments by {-margin:.2g} of their sum)"
            )
    return out


def _massless(model: pin.Model) -> list[str]:
    """Find joints that move no mass: M is singular there.

    A body without mass that carries others is fine: wrists are often modelled as two joints at one point.
    """
    carried = [model.inertias[i].mass for i in range(model.njoints)]
    for i in range(model.njoints - 1, 0, -1):
        carried[model.parents[i]] += carried[i]
    return [
        f"joint '{model.names[i]}': mass 0 on everything that it moves; the mass matrix is singular"
        for i in range(1, model.njoints)
        if carried[i] <= 0
    ]


def _ranges(model: pin.Model) -> list[str]:
    """Find joints whose range has no width: exporters write 0 and 0 where they know no limit."""
    out = []
    for i in range(1, model.njoints):
        at = model.joints[i].idx_q
        lower, upper = model.lowerPositionLimit[at], model.upperPositionLimit[at]
        if lower >= upper:
            out.append(
                f"joint '{model.names[i]}': its range is [{lower:g}, {upper:g}]; it is taken as unlimited"
            )
    return out


def _lost_mimics(urdf: Urdf, model: pin.Model) -> list[str]:
    """Find locked mimic joints whose leader moves: this model does not have that linkage."""
    moving = set(model.names[1:])
    return [
        f"joint '{j.name}' mimics the moving joint '{j.mimic.followed}': it is locked, and its motion is not modelled"
        for j in urdf.joints.values()
        if j.mimic is not None and j.mimic.followed in moving
    ]
