"""Numbers of a URDF: poses, inertias, positions of held joints."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping

import numpy as np
import pinocchio as pin
from lxml import etree
from numpy.typing import NDArray

from cdia_pin.errors import RobotError
from cdia_pin.robot.inertia import parameters_of

Array = NDArray[np.float64]


def inertial_of(link: etree._Element, where: str) -> Array | None:
    """Ten parameters in the link's frame from its ``<inertial>``, shape (10,); None if there is none."""
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
    """``xyz`` [m] and ``rpy`` [rad] of an ``<origin>``; zero where it is left out."""
    out = []
    for key in ("xyz", "rpy"):
        text = "0 0 0" if origin is None else origin.get(key, "0 0 0")
        values = [number(t, where, key) for t in text.split()]
        if len(values) != 3:
            raise RobotError(f"{where}: {key} needs three numbers, given '{text}'")
        out.append(np.array(values))
    return out[0], out[1]


def homogeneous(origin: etree._Element | None, where: str) -> Array:
    """Pose of an ``<origin>``, shape (4, 4) [1, m]."""
    xyz, rpy = pose_of(origin, where)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation(rpy), xyz
    return T


def axis_of(joint: etree._Element, where: str) -> Array:
    """Unit axis of a joint in its own frame, shape (3,); x where it is left out."""
    element = joint.find("axis")
    text = "1 0 0" if element is None else str(element.get("xyz", "1 0 0"))
    axis = np.array([number(t, where, "axis") for t in text.split()])
    if axis.shape != (3,) or not axis.any():
        raise RobotError(f"{where}: the axis must be three numbers, not all zero, given '{text}'")
    return axis / np.linalg.norm(axis)


def rotation(rpy: Array) -> Array:
    """Rotation matrix of URDF's roll, pitch, yaw about fixed axes [rad], shape (3, 3)."""
    return np.asarray(pin.rpy.rpyToMatrix(rpy))


def number(text: str | None, where: str, what: str) -> float:
    """Read a number, or say where it is missing; ranges may be infinite."""
    try:
        value = float(text or "")
    except ValueError:
        raise RobotError(f"{where}: {what} must be a number, given '{text}'") from None
    if not math.isfinite(value) and what not in {"lower", "upper"}:
        raise RobotError(f"{where}: {what} must be finite, given '{text}'")
    return value


def welded(tree: etree._ElementTree, positions: Mapping[str, float]) -> str:
    """The URDF's text with some joints fixed where they are held.

    Pinocchio's ``buildReducedModel`` would do, but fails where a link and a joint share a name.

    Args:
        tree: The URDF; it is not changed.
        positions: Held joints, with their position [rad or m].

    Returns:
        XML text.
    """
    tree = copy.deepcopy(tree)
    for element in tree.getroot().findall("joint"):
        position = positions.get(str(element.get("name")))
        if position is None:
            continue
        if position != 0.0:
            _displace(element, position, f"joint '{element.get('name')}'")
        element.set("type", "fixed")
    return str(etree.tostring(tree.getroot(), encoding="unicode"))


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
