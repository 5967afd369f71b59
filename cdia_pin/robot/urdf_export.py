"""Writing of corrected inertias, friction and payload into an arm's URDF, which stays unchanged otherwise.

Pinocchio merges links that are fixed to each other into one body per joint, and these bodies are identified. A URDF
states links: the correction of a body goes to the link that the joint moves. The body's total is then right, and
hands, sensors and locked fingers keep their own values.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TypedDict, Unpack

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
from cdia_pin.robot.urdf import Urdf, read_urdf, urdf_of
from cdia_pin.robot.urdf_edit import (
    add_note,
    child_of,
    lay_out,
    rebase_meshes,
    remove,
    text_of,
    write_beside,
    write_inertial,
)
from cdia_pin.robot.urdf_values import homogeneous
from cdia_pin.version import __version__

Array = NDArray[np.float64]

PAYLOAD_LINK = "cdia_payload"


class UrdfChanges(TypedDict, total=False):
    """Values that a URDF can get, as `write_corrected_urdf` takes them; their keys are its keywords."""

    inertial: Mapping[str, ArrayLike] | None
    damping: Mapping[str, float] | None
    friction: Mapping[str, float] | None
    payload: ArrayLike | None


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

    Comments, meshes and order stay. Relative mesh paths are rewritten for the new folder. A URDF cannot state
    gravity, rotor inertia or any other effect; they are not written.

    Args:
        robot: The arm; its file is read again and is not changed.
        path: File to write.
        inertial: Per joint the ten parameters [kg, kg·m, kg·m²] of all links that move with it, about the
            joint's frame, in the order of ``robot.inertial_parameters``.
        damping: Per joint ``<dynamics damping>`` [N·m·s/rad or N·s/m].
        friction: Per joint ``<dynamics friction>`` [N·m or N].
        payload: A body on the tool frame, about that frame: ten parameters, or mass [kg] and first
            moments [kg·m] of a point. A payload that is not physically consistent, such as a tool of the file
            that the arm lacks, is added to the last link instead of becoming a link.
        allow_unphysical: Write inertias that are not physically consistent; most simulators refuse them.

    Returns:
        The file written.

    Raises:
        RobotError: If a joint is unknown, a value is not possible, or the file would overwrite the original.
    """
    path = Path(path).expanduser()
    text = corrected_urdf(
        robot,
        path.parent,
        inertial=inertial,
        damping=damping,
        friction=friction,
        payload=payload,
        allow_unphysical=allow_unphysical,
    )
    return write_beside(robot.urdf, path, text)


def corrected_urdf(
    robot: RobotModel, folder: Path, *, allow_unphysical: bool = False, **changes: Unpack[UrdfChanges]
) -> str:
    """Return the text that `write_corrected_urdf` writes.

    Args:
        robot: The arm; its file is read again and is not changed.
        folder: Folder from which relative mesh paths shall hold.
        allow_unphysical: As in `write_corrected_urdf`.
        **changes: As in `write_corrected_urdf`.

    Returns:
        Text of the URDF.

    Raises:
        RobotError: If a joint is unknown, or a value is not possible.
    """
    urdf = corrected_tree(robot, allow_unphysical=allow_unphysical, **changes)
    rebase_meshes(urdf.tree, urdf.path.parent, folder)
    add_note(urdf.tree, _summary(robot, changes))
    return text_of(urdf.tree)


def corrected_tree(
    robot: RobotModel, *, allow_unphysical: bool = False, **changes: Unpack[UrdfChanges]
) -> Urdf:
    """Return the corrected URDF as a tree of links and joints; its meshes are still named from the robot's folder.

    Args:
        robot: The arm; its file is read again and is not changed.
        allow_unphysical: As in `write_corrected_urdf`.
        **changes: As in `write_corrected_urdf`.

    Raises:
        RobotError: If a joint is unknown, or a value is not possible.
    """
    urdf = read_urdf(robot.urdf)
    totals = {joint: _ten(joint, given) for joint, given in (changes.get("inertial") or {}).items()}
    damping, friction = changes.get("damping") or {}, changes.get("friction") or {}
    for joint in (*totals, *damping, *friction):
        robot.joint_index(joint)
    if (payload := changes.get("payload")) is not None:
        _add_payload(robot, urdf, _payload(payload), totals)
    for joint, total in totals.items():
        _set_body(robot, urdf, joint, total, allow_unphysical)
    _set_dynamics(urdf, "damping", damping)
    _set_dynamics(urdf, "friction", friction)
    return urdf_of(urdf.tree, urdf.path)


def _set_body(robot: RobotModel, urdf: Urdf, joint: str, total: Array, allow_unphysical: bool) -> None:
    """Set the inertia of the link that a joint moves so that the body's total is right."""
    if not allow_unphysical and not is_physical(total):
        raise RobotError(
            f"joint '{joint}': no body can have these inertial parameters (mass {total[0]:.4g} kg, margin "
            f"{physical_margin(total):.2g} < 0); simulators refuse them; fit within physical bounds"
        )
    link = urdf.joints[joint].child
    stated = urdf.link_parameters(link)
    own = np.zeros(10) if stated is None else stated
    fastened = robot.inertial_parameters[robot.joint_index(joint)] - own
    left = total - fastened
    left[np.abs(left) < 1e-14 * max(np.abs(total).max(), np.abs(fastened).max())] = 0.0  # rounding errors
    if is_physical(total) and not is_physical(left):
        # The link alone has less than must be removed: the links fixed to it are merged into it. Links of
        # locked joints keep their inertia, because other programs let these joints move.
        for other, pose in list(_fixed_to(urdf, link, np.eye(4))):
            parameters = urdf.link_parameters(other)
            if parameters is not None:
                left = left + transform_parameters(pose) @ parameters
                remove(urdf.links[other].find("inertial"))
    if not allow_unphysical and not is_physical(left):
        raise RobotError(
            f"joint '{joint}': its total is possible, but the rest for link '{link}' beside the locked "
            "joints is not; remove the links of these joints from the file"
        )
    write_inertial(urdf.links[link], left)


def _fixed_to(urdf: Urdf, link: str, pose: Array) -> Iterator[tuple[str, Array]]:
    """Find the links that the file fixes to a link, with their pose in that link [1, m], shape (4, 4)."""
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
    if carrier not in urdf.links:  # the frame of a joint: fasten the payload to the link that it moves
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


def _summary(robot: RobotModel, changes: UrdfChanges) -> str:
    """Summarise the changes, for the head of the file."""
    per_joint = {
        "inertial": changes.get("inertial"),
        "damping": changes.get("damping"),
        "friction": changes.get("friction"),
    }
    parts = [f"{what} of {', '.join(joints)}" for what, joints in per_joint.items() if joints]
    if changes.get("payload") is not None:
        parts.append(f"payload on {robot.tool_frame}")
    said = "; ".join(parts) or "nothing changed"
    return f"{robot.urdf.name} corrected by cdia-pin {__version__}: {said}"


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
