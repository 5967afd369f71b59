"""Numbers of a URDF: poses, inertias, positions of locked joints."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping

import numpy as np
import pinocchio as pin
from lxml import etree
from numpy.typing import NDArray

from cdia_pin.errors import RobotError
from cdia_pin.phrases import counted, shortened
from cdia_pin.robot.inertia import parameters_of

Array = NDArray[np.float64]

# What states the size of a shape, how many numbers it has, and the least: a mesh may be mirrored.
SIZES = {
    "mesh": (("scale",), 3, -math.inf),
    "box": (("size",), 3, 0.0),
    "cylinder": (("radius", "length"), 2, 0.0),
    "sphere": (("radius",), 1, 0.0),
    "capsule": (("radius", "length"), 2, 0.0),
}

LARGEST = 1e12  # [unit of the file], larger numbers are no lengths or masses, and overflow in a product


def inertial_of(link: etree._Element, where: str) -> Array | None:
    """Read the inertial parameters of a link.

    Args:
        link: The ``<link>`` element.
        where: Name of the link, for messages.

    Returns:
        Ten parameters in the link's frame [kg, kg·m, kg·m²], shape (10,); None without ``<inertial>``.

    Raises:
        RobotError: If a part is missing or not a number.
    """
    inertial = link.find("inertial")
    if inertial is None:
        return None
    mass, tensor = inertial.find("mass"), inertial.find("inertia")
    if mass is None or tensor is None:
        raise RobotError(f"{where}: <inertial> needs <mass> and <inertia>")
    xyz, rpy = pose_of(inertial.find("origin"), where)
    upper = {k: number(tensor.get(k), where, k) for k in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")}
    body = np.array(
        [
            [upper["ixx"], upper["ixy"], upper["ixz"]],
            [upper["ixy"], upper["iyy"], upper["iyz"]],
            [upper["ixz"], upper["iyz"], upper["izz"]],
        ]
    )
    R = rotation(rpy)
    return parameters_of(number(mass.get("value"), where, "mass"), xyz, R @ body @ R.T)


def pose_of(origin: etree._Element | None, where: str) -> tuple[Array, Array]:
    """Read a pose.

    Args:
        origin: The ``<origin>`` element; a missing element or attribute means zero.
        where: Name of its parent, for messages.

    Returns:
        ``xyz`` [m] and ``rpy`` [rad], shape (3,) each.

    Raises:
        RobotError: If an attribute is not three numbers.
    """
    out = []
    for key in ("xyz", "rpy"):
        text = "0 0 0" if origin is None else origin.get(key, "0 0 0")
        values = [number(t, where, key) for t in text.split()]
        if len(values) != 3:
            raise RobotError(f"{where}: {key} needs three numbers, given '{text}'")
        out.append(np.array(values))
    return out[0], out[1]


def homogeneous(origin: etree._Element | None, where: str) -> Array:
    """Read a pose as a homogeneous matrix.

    Args:
        origin: The ``<origin>`` element, or None.
        where: Name of its parent, for messages.

    Returns:
        Pose [1, m], shape (4, 4).
    """
    xyz, rpy = pose_of(origin, where)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation(rpy), xyz
    return T


def axis_of(joint: etree._Element, where: str) -> Array:
    """Read the axis of a joint.

    Args:
        joint: The ``<joint>`` element.
        where: Name of the joint, for messages.

    Returns:
        Unit vector in the joint's frame [1], shape (3,); x where none is stated.

    Raises:
        RobotError: If the axis is not three numbers, or all of them are zero.
    """
    element = joint.find("axis")
    text = "1 0 0" if element is None else str(element.get("xyz", "1 0 0"))
    axis = np.array([number(t, where, "axis") for t in text.split()])
    if axis.shape != (3,) or not axis.any():
        raise RobotError(f"{where}: the axis must be three numbers, not all zero, given '{text}'")
    return np.asarray(axis / np.linalg.norm(axis))


def size_of(shape: etree._Element, where: str) -> tuple[float, ...]:
    """Read the size of a shape.

    Args:
        shape: Its element, the child of ``<geometry>``.
        where: Name of its link, for messages.

    Returns:
        Edges of a box, radius and length of a cylinder or capsule, radius of a sphere [m]; scale of a mesh [1].

    Raises:
        RobotError: If the kind of shape is unknown, or its size cannot be read.
    """
    kind = str(shape.tag)
    if kind not in SIZES:
        raise RobotError(f"{where}: unknown shape '{kind}'; known: {', '.join(SIZES)}")
    keys, count, least = SIZES[kind]
    given = " ".join(str(shape.get(key, "1 1 1" if key == "scale" else "")) for key in keys)
    size = tuple(number(t, where, f"the {' or '.join(keys)} of a {kind}", least) for t in given.split())
    if len(size) != count:
        raise RobotError(
            f"{where}: a {kind} needs {counted(count, 'number')} for {' and '.join(keys)}, given '{given.strip()}'"
        )
    return size


def rotation(rpy: Array) -> Array:
    """Compute the rotation matrix of URDF's roll, pitch and yaw about fixed axes.

    Args:
        rpy: Angles [rad], shape (3,).

    Returns:
        Rotation matrix [1], shape (3, 3).
    """
    return np.asarray(pin.rpy.rpyToMatrix(rpy))


def number(text: str | None, where: str, what: str, least: float = -math.inf) -> float:
    """Read a number.

    Args:
        text: Text of an attribute; None if it is missing.
        where: Name of the element, for messages.
        what: Name of the attribute.
        least: Smallest value that makes sense [unit of the file].

    Returns:
        The number, in the unit of the file.

    Raises:
        RobotError: If it is missing, not a number, infinite, or too small or large.
    """
    if text is None:
        raise RobotError(f"{where}: {what} is missing, it must be a number")
    given = f"given '{shortened(text)[1:-1]}'"
    try:
        value = float(text if "_" not in text else "")  # Python reads 1_0 as ten, and nothing else does
    except ValueError:
        raise RobotError(f"{where}: {what} must be a number, {given}") from None
    if not math.isfinite(value):
        raise RobotError(f"{where}: {what} must be finite, {given}")
    if abs(value) > LARGEST:
        raise RobotError(f"{where}: {what} must be below {LARGEST:g}, {given}")
    if value < least:
        raise RobotError(f"{where}: {what} must be {least:g} or more, {given}")
    return value


# What a fixed joint of a URDF does not have.
MOTION = ("axis", "calibration", "dynamics", "limit", "mimic", "safety_controller")


def welded(tree: etree._ElementTree, positions: Mapping[str, float]) -> etree._ElementTree:
    """Return a URDF with the locked joints fixed at their positions.

    Pinocchio's ``buildReducedModel`` fails where a link and a joint share a name.

    Args:
        tree: The URDF; it is not changed.
        positions: Locked joints, with their position [rad or m].

    Returns:
        Another tree.
    """
    tree = copy.deepcopy(tree)
    for element in tree.getroot().findall("joint"):
        position = positions.get(str(element.get("name")))
        if position is None:
            continue
        if position != 0.0:
            _displace(element, position, f"joint '{element.get('name')}'")
        element.set("type", "fixed")
        etree.strip_elements(element, *MOTION, with_tail=False)
    return tree


def _displace(joint: etree._Element, position: float, where: str) -> None:
    """Move a joint's origin along or about its axis."""
    origin = joint.find("origin")
    xyz, rpy = pose_of(origin, where)
    axis = axis_of(joint, where)
    R = rotation(rpy)
    if joint.get("type") == "prismatic":
        xyz = xyz + R @ axis * position
    else:
        R = R @ pin.exp3(axis * position)
    if origin is None:
        origin = etree.SubElement(joint, "origin")
    origin.set("xyz", " ".join(repr(float(x)) for x in xyz))
    origin.set("rpy", " ".join(repr(float(x)) for x in pin.rpy.matrixToRpy(R)))
