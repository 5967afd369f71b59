"""A URDF arm as a MuJoCo model with the same rigid-body dynamics, and nothing besides.

MuJoCo's reader of URDF takes more than an arm's dynamics from the file (damping, friction, limits, meshes),
and refuses inertias that real files do contain (zero, or against the triangle inequality). So the tree is
given to MuJoCo with placeholder inertias, and the file's own are written into the compiled model.
"""

from __future__ import annotations

import warnings
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from cdia_pin.errors import RobotError, unknown_name

Array = NDArray[np.float64]

# Off centre and skewed, so that the compiler takes no shortcut which the true inertia would break.
PLACEHOLDER = """<inertial><origin xyz=".01 .02 .03" rpy=".1 .2 .3"/><mass value="1"/>
<inertia ixx="1" iyy="1.1" izz="1.2" ixy="0" ixz="0" iyz="0"/></inertial>"""
TOOL_BODY = "plant/tool"  # massless, at the tool's frame, where a wrench acts
COMPILER = '<mujoco><compiler fusestatic="false" balanceinertia="false" discardvisual="true"/></mujoco>'


@dataclass(frozen=True)
class LinkInertia:
    """Inertia of one link as its file states it.

    Attributes:
        mass: Mass [kg].
        com: Centre of mass in the link's frame [m], shape (3,).
        tensor: Inertia about the centre of mass, axes of the link [kg·m²], shape (3, 3).
    """

    mass: float
    com: Array
    tensor: Array


@dataclass(frozen=True)
class ArmFile:
    """What a URDF says about an arm.

    Attributes:
        xml: Kinematic tree with placeholder inertias, for MuJoCo.
        inertias: Inertia of each link that has one.
        children: Link moved by each joint, fixed ones included.
    """

    xml: str
    inertias: Mapping[str, LinkInertia]
    children: Mapping[str, str]


def read_arm(urdf: Path, locked: Mapping[str, float]) -> ArmFile:
    """Read a URDF, with some of its joints held at a fixed position.

    Args:
        urdf: The file.
        locked: Position [rad or m] of each joint that does not move.

    Raises:
        RobotError: If a locked joint does not exist, or a movable one has more than one degree of freedom.
    """
    source = ET.parse(urdf).getroot()
    joints = source.findall("joint")
    names = [j.get("name", "") for j in joints]
    for name in locked:
        if name not in names:
            raise RobotError(f"{urdf.name}: " + unknown_name("joint", name, names))
    tree = ET.Element("robot", name=source.get("name", "arm"))
    tree.append(ET.fromstring(COMPILER))
    children = {j.get("name", ""): _attribute(j, "child", "link") for j in joints}
    inertias = {}
    for link in source.findall("link"):
        name = link.get("name", "")
        inertial = link.find("inertial")
        if inertial is not None:
            inertias[name] = _inertia(inertial)
        bare = ET.SubElement(tree, "link", name=name)
        if name in children.values():  # the root becomes MuJoCo's world, which has no inertia
            bare.append(ET.fromstring(PLACEHOLDER))
    for joint in joints:
        tree.append(_bare_joint(joint, locked))
    return ArmFile(ET.tostring(tree, encoding="unicode"), inertias, children)


def write_inertia(model: mujoco.MjModel, body: int, link: LinkInertia) -> None:
    """Give a body of a compiled model any inertia, physical or not."""
    moments, axes = np.linalg.eigh(link.tensor)
    axes[:, 2] *= np.sign(np.linalg.det(axes))  # a rotation, not a reflection
    model.body_mass[body] = link.mass
    model.body_ipos[body] = link.com
    model.body_inertia[body] = moments
    mujoco.mju_mat2Quat(model.body_iquat[body], axes.ravel())


def read_inertia(model: mujoco.MjModel, body: int) -> LinkInertia:
    """Return the inertia that a body of a compiled model has now."""
    axes = np.empty(9)
    mujoco.mju_quat2Mat(axes, model.body_iquat[body])
    R = axes.reshape(3, 3)
    tensor = R @ np.diag(model.body_inertia[body]) @ R.T
    return LinkInertia(float(model.body_mass[body]), model.body_ipos[body].copy(), tensor)


# ---------------------------------------------------------------- elements


def _bare_joint(joint: ET.Element, locked: Mapping[str, float]) -> ET.Element:
    """Return a joint without limits, damping, friction and mimicry; a locked one becomes fixed."""
    name, kind = joint.get("name", ""), joint.get("type", "")
    xyz, rotation = _origin(joint)
    bare = ET.Element("joint", name=name)
    ET.SubElement(bare, "parent", link=_attribute(joint, "parent", "link"))
    ET.SubElement(bare, "child", link=_attribute(joint, "child", "link"))
    if kind == "fixed" or name in locked:
        bare.set("type", "fixed")
        if name in locked and kind != "fixed":
            along = locked[name] * _axis(joint)
            if kind == "prismatic":
                xyz = xyz + rotation.apply(along)
            else:
                rotation = rotation * Rotation.from_rotvec(along)
    elif kind in {"revolute", "continuous", "prismatic"}:
        bare.set("type", "prismatic" if kind == "prismatic" else "continuous")
        ET.SubElement(bare, "axis", xyz=_text(_axis(joint)))
    else:
        raise RobotError(f"joint '{name}' is {kind}; an arm has revolute, continuous and prismatic joints")
    ET.SubElement(bare, "origin", xyz=_text(xyz), rpy=_text(_roll_pitch_yaw(rotation)))
    return bare


def _inertia(inertial: ET.Element) -> LinkInertia:
    com, rotation = _origin(inertial)
    mass, tensor = inertial.find("mass"), inertial.find("inertia")
    i = {k: float(v) for k, v in tensor.items()} if tensor is not None else {}
    xx, xy, xz, yy, yz, zz = (i.get(k, 0.0) for k in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    R = rotation.as_matrix()
    about_com = R @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R.T
    return LinkInertia(float(mass.get("value", "0")) if mass is not None else 0.0, com, about_com)


def _origin(element: ET.Element) -> tuple[Array, Rotation]:
    origin = element.find("origin")
    values = {} if origin is None else dict(origin.items())
    xyz = np.array(values.get("xyz", "0 0 0").split(), float)
    return xyz, Rotation.from_euler("xyz", np.array(values.get("rpy", "0 0 0").split(), float))


def _roll_pitch_yaw(rotation: Rotation) -> Array:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # at a pitch of 90° roll is free, and SciPy's choice of 0 serves
        return np.asarray(rotation.as_euler("xyz"))


def _axis(joint: ET.Element) -> Array:
    axis = joint.find("axis")
    direction = np.array(("1 0 0" if axis is None else axis.get("xyz", "1 0 0")).split(), float)
    return direction / np.linalg.norm(direction)


def _attribute(element: ET.Element, tag: str, key: str) -> str:
    found = element.find(tag)
    return "" if found is None else found.get(key, "")


def _text(values: Array) -> str:
    return " ".join(repr(float(v)) for v in values)
