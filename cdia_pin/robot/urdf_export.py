"""Write what was found about an arm back into its URDF, leaving everything else as it stands.

Pinocchio merges links that are fixed to each other into one body per joint, and that is what is
identified. A URDF states links: the correction of a body goes to the link that the joint moves, so that
the body's total is right and hands, sensors and held fingers keep their own values.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from lxml import etree
from numpy.typing import ArrayLike, NDArray

from cdia_pin.errors import RobotError
from cdia_pin.robot.inertia import (
    is_physical,
    parameters_of,
    physical_margin,
    transform_parameters,
)
from cdia_pin.robot.model import RobotModel
from cdia_pin.robot.urdf import Urdf, read_urdf
from cdia_pin.robot.urdf_edit import (
    add_note,
    child_of,
    lay_out,
    rebase_meshes,
    remove,
    text_of,
    write_inertial,
)
from cdia_pin.robot.urdf_values import homogeneous
from cdia_pin.version import __version__

Array = NDArray[np.float64]

PAYLOAD_LINK = "cdia_payload"


def write_corrected_urdf(
    robot: RobotModel,
    path: str | Path,
    *,
    inertial: Mapping[str, ArrayLike] | None = None,
    damping: Mapping[str, float] | None = None,
    friction: Mapping[str, float] | None = None,
    payload: ArrayLike | None = None,
    allow_unphysical: bool = False,
) -> Path:
    """Write the robot's URDF with other inertias, joint damping and friction, or with a payload.

    Comments, meshes and order stay. Relative mesh paths are rewritten to hold from the new place.
    Gravity, rotor inertia and any other effect have no place in a URDF and are not written.

    Args:
        robot: The arm; its file is read again and is not changed.
        path: File to write.
        inertial: Per joint the ten parameters of all that moves with it, about the joint's frame, in the
            order of ``robot.inertial_parameters``.
        damping: Per joint ``<dynamics damping>`` [N·m·s/rad or N·s/m].
        friction: Per joint ``<dynamics friction>`` [N·m or N].
        payload: A body on the tool frame, about that frame: ten parameters, or mass [kg] and first
            moments [kg·m] of a point. One that no body can have (the arm lacks a tool that the file has)
            is taken off the last link instead of being added as a link.
        allow_unphysical: Write inertias that no body can have; most simulators will refuse them.

    Returns:
        The file written.

    Raises:
        RobotError: If a joint is unknown, a value cannot be, or the file would overwrite the original.
    """
    path = Path(path).expanduser()
    if path.resolve() == robot.urdf.resolve():
        raise RobotError(f"{path} is the robot's own file: give another name")
    text = corrected_urdf(
        robot,
        path.parent,
        inertial=inertial,
        damping=damping,
        friction=friction,
        payload=payload,
        allow_unphysical=allow_unphysical,
    )
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise RobotError(f"cannot write {path}: {error.strerror or error}") from None
    return path


def corrected_urdf(
    robot: RobotModel,
    folder: Path,
    *,
    inertial: Mapping[str, ArrayLike] | None = None,
    damping: Mapping[str, float] | None = None,
    friction: Mapping[str, float] | None = None,
    payload: ArrayLike | None = None,
    allow_unphysical: bool = False,
) -> str:
    """Return the text that `write_corrected_urdf` writes into a folder; the other arguments are its own.

    Raises:
        RobotError: If a joint is unknown, or a value cannot be.
    """
    urdf = read_urdf(robot.urdf)
    totals = {joint: _ten(joint, given) for joint, given in (inertial or {}).items()}
    for joint in (*totals, *(damping or {}), *(friction or {})):
        robot.joint_index(joint)
    if payload is not None:
        _add_payload(robot, urdf, _payload(payload), totals)
    for joint, total in totals.items():
        _set_body(robot, urdf, joint, total, allow_unphysical)
    _set_dynamics(urdf, "damping", damping or {})
    _set_dynamics(urdf, "friction", friction or {})
    rebase_meshes(urdf.tree, urdf.path.parent, folder)
    changed = {"inertial": inertial, "damping": damping, "friction": friction}
    add_note(urdf.tree, _summary(robot, changed, payload is not None))
    return text_of(urdf.tree)


def _set_body(robot: RobotModel, urdf: Urdf, joint: str, total: Array, allow_unphysical: bool) -> None:
    """Give the link that a joint moves what makes its body's total right."""
    if not allow_unphysical and not is_physical(total):
        raise RobotError(
            f"joint '{joint}': no body can have these inertial parameters (mass {total[0]:.4g} kg, margin "
            f"{physical_margin(total):.2g} < 0); fit with physical bounds, or give allow_unphysical=True"
        )
    link = urdf.joints[joint].child
    stated = urdf.link_parameters(link)
    own = np.zeros(10) if stated is None else stated
    fastened = robot.inertial_parameters[robot.joint_index(joint)] - own
    left = total - fastened
    left[np.abs(left) < 1e-14 * max(np.abs(total).max(), np.abs(fastened).max())] = 0.0  # rounding
    if is_physical(total) and not is_physical(left):
        # The link cannot give so much: the links fixed to it give theirs too. Held joints keep theirs,
        # because other programs let them move.
        for other, pose in list(_fixed_to(urdf, link, np.eye(4))):
            parameters = urdf.link_parameters(other)
            if parameters is not None:
                left = left + transform_parameters(pose) @ parameters
                remove(urdf.links[other].find("inertial"))
    if not allow_unphysical and not is_physical(left):
        raise RobotError(
            f"joint '{joint}': its total could exist, but what is left for link '{link}' beside the held "
            "joints could not; drop what hangs on it from the file, or give allow_unphysical=True"
        )
    write_inertial(urdf.links[link], left)


def _fixed_to(urdf: Urdf, link: str, pose: Array) -> Iterator[tuple[str, Array]]:
    """Links welded to a link by the file itself, with their pose in that link."""
    for joint in urdf.joints.values():
        if joint.parent == link and not joint.is_movable:
            there = pose @ homogeneous(joint.element.find("origin"), f"joint '{joint.name}'")
            yield joint.child, there
            yield from _fixed_to(urdf, joint.child, there)


def _add_payload(robot: RobotModel, urdf: Urdf, payload: Array, totals: dict[str, Array]) -> None:
    joint = robot.tool_joint
    if not is_physical(payload):
        before = totals.get(joint, robot.inertial_parameters[robot.joint_index(joint)])
        totals[joint] = before + transform_parameters(robot.tool_placement) @ payload
        return
    pose = np.eye(4)
    carrier = robot.tool_frame
    if carrier not in urdf.links:  # a joint's frame: fasten to the link behind it
        carrier, pose = urdf.joints[joint].child, robot.tool_placement
    name = PAYLOAD_LINK
    while name in urdf.links or f"{name}_joint" in urdf.joints:
        name += "_"
    root = urdf.tree.getroot()
    fixed = etree.SubElement(root, "joint", name=f"{name}_joint", type="fixed")
    etree.SubElement(fixed, "parent", link=carrier)
    etree.SubElement(fixed, "child", link=name)
    body = etree.SubElement(root, "link", name=name)
    write_inertial(body, transform_parameters(pose) @ payload)
    lay_out(root, 2)


def _set_dynamics(urdf: Urdf, key: str, values: Mapping[str, float]) -> None:
    for joint, value in values.items():
        if not np.isfinite(value) or value < 0:
            raise RobotError(f"joint '{joint}': {key} must be zero or more, given {value}")
        child_of(urdf.joints[joint].element, "dynamics").set(key, repr(float(value)))


def _summary(
    robot: RobotModel, per_joint: Mapping[str, Mapping[str, object] | None], has_payload: bool
) -> str:
    """Say at the head of the file what was changed."""
    parts = [f"{what} of {', '.join(joints)}" for what, joints in per_joint.items() if joints]
    if has_payload:
        parts.append(f"payload on {robot.tool_frame}")
    changes = "; ".join(parts) or "nothing changed"
    return f"{robot.urdf.name} corrected by cdia-pin {__version__}: {changes}"


def _ten(joint: str, given: ArrayLike) -> Array:
    parameters = np.asarray(given, dtype=np.float64)
    if parameters.shape != (10,) or not np.all(np.isfinite(parameters)):
        raise RobotError(
            f"joint '{joint}': ten finite inertial parameters are needed, given shape {parameters.shape}"
        )
    return parameters


def _payload(given: ArrayLike) -> Array:
    values = np.asarray(given, dtype=np.float64)
    if values.shape == (4,):
        mass = float(values[0])
        com = values[1:] / mass if mass != 0.0 else values[1:]
        return parameters_of(mass, com, np.zeros((3, 3)))
    if values.shape != (10,) or not np.all(np.isfinite(values)):
        raise RobotError(
            f"payload: ten parameters, or mass and first moments, are needed, given {values.shape}"
        )
    return values
