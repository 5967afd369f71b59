"""A URDF file as a tree of links and joints, checked before Pinocchio reads it.

Pinocchio's parser answers every fault with the same sentence, takes an unreadable inertia for zero and
knows nothing of mimic joints: the faults are named here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from lxml import etree

from cdia_pin.errors import RobotError
from cdia_pin.robot.urdf_values import Array, axis_of, inertial_of, number, pose_of

MOVABLE = ("revolute", "continuous", "prismatic")
_KINDS = (*MOVABLE, "fixed", "floating", "planar")


@dataclass(frozen=True)
class Mimic:
    """q = multiplier · q_followed + offset."""

    followed: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class UrdfJoint:
    """A joint as its file states it; positions in rad or m."""

    name: str
    kind: str
    parent: str
    child: str
    lower: float
    upper: float
    mimic: Mimic | None
    element: etree._Element

    @property
    def is_movable(self) -> bool:
        """Whether the joint has a degree of freedom."""
        return self.kind != "fixed"


@dataclass(frozen=True)
class Urdf:
    """A parsed URDF.

    Attributes:
        path: The file.
        tree: Its XML, with comments, as it stands in the file.
        links: Link elements by name.
        joints: Joints by name, in the order of the file.
    """

    path: Path
    tree: etree._ElementTree
    links: dict[str, etree._Element]
    joints: dict[str, UrdfJoint]

    @property
    def root(self) -> str:
        """The link that no joint moves."""
        children = {j.child for j in self.joints.values()}
        return next(name for name in self.links if name not in children)

    def joint_above(self, link: str) -> UrdfJoint | None:
        """The joint whose child is the link; none for the root."""
        return next((j for j in self.joints.values() if j.child == link), None)

    def joints_below(self, joint: str) -> Iterator[UrdfJoint]:
        """Every joint further out, through fixed ones too."""
        for j in self.joints.values():
            if j.parent == self.joints[joint].child:
                yield j
                yield from self.joints_below(j.name)

    def link_parameters(self, link: str) -> Array | None:
        """Ten inertial parameters in the link's frame, shape (10,); None if the link states none."""
        return inertial_of(self.links[link], f"{self.path.name}: link '{link}'")


def read_urdf(path: Path) -> Urdf:
    """Read and check a URDF file.

    Raises:
        RobotError: If it is missing, not XML, not a URDF, or not one tree of links.
    """
    tree = _parse(path)
    root = tree.getroot()
    links = {_need(e, "name", path): e for e in root.findall("link")}
    joints = {j.name: j for j in (_joint(e, path) for e in root.findall("joint"))}
    if not links:
        raise RobotError(f"{path}: no <link> in this file")
    for j in joints.values():
        for role, link in (("parent", j.parent), ("child", j.child)):
            if link not in links:
                raise RobotError(
                    f"{path}: joint '{j.name}' has the {role} link '{link}', which is not defined"
                )
    children = [j.child for j in joints.values()]
    for link in links:
        if children.count(link) > 1:
            raise RobotError(f"{path}: link '{link}' is the child of more than one joint")
    roots = [name for name in links if name not in children]
    if len(roots) != 1:
        held = ", ".join(roots) if roots else "none"
        raise RobotError(f"{path}: a URDF has exactly one link without a parent joint, found {held}")
    urdf = Urdf(path, tree, links, joints)
    for link in links:
        urdf.link_parameters(link)  # says what is wrong; Pinocchio would take it for no inertia at all
    return urdf


def _parse(path: Path) -> etree._ElementTree:
    if not path.is_file():
        raise RobotError(f"no such URDF file: {path}")
    if path.suffix == ".xacro":
        raise RobotError(f"{path}: xacro must be expanded first: xacro {path.name} > {path.stem}")
    try:
        # No entity and no address in a robot's file may make this process read something else.
        tree = etree.parse(str(path), etree.XMLParser(resolve_entities=False, no_network=True))
    except etree.XMLSyntaxError as error:
        raise RobotError(f"{path}: not an XML file ({error.msg})") from None
    root = tree.getroot()
    if root.tag != "robot":
        raise RobotError(f"{path}: a URDF begins with <robot>, this file with <{root.tag}>")
    if not root.get("name"):
        raise RobotError(f"{path}: <robot> needs a name")
    return tree


def _joint(element: etree._Element, path: Path) -> UrdfJoint:
    name = _need(element, "name", path)
    where = f"{path}: joint '{name}'"
    kind = element.get("type", "")
    if kind not in _KINDS:
        raise RobotError(f"{where}: unknown type '{kind}'; known: {', '.join(_KINDS)}")
    ends = [element.find(role) for role in ("parent", "child")]
    if any(e is None or not e.get("link") for e in ends):
        raise RobotError(f"{where}: needs <parent link=...> and <child link=...>")
    parent, child = (str(e.get("link")) for e in ends if e is not None)
    limit = element.find("limit")
    if limit is None and kind in {"revolute", "prismatic"}:
        raise RobotError(f"{where}: a {kind} joint needs <limit lower upper effort velocity>")
    if kind in MOVABLE:
        axis_of(element, where)
    pose_of(element.find("origin"), where)
    lower, upper = -math.inf, math.inf
    if limit is not None and kind != "continuous":
        lower, upper = (number(limit.get(k, "0"), where, k) for k in ("lower", "upper"))
    return UrdfJoint(name, kind, parent, child, lower, upper, _mimic(element, where), element)


def _mimic(element: etree._Element, where: str) -> Mimic | None:
    mimic = element.find("mimic")
    # PAL's files leave <mimic> on joints that they have made fixed: nothing moves there.
    if mimic is None or element.get("type") == "fixed":
        return None
    multiplier = number(mimic.get("multiplier", "1"), where, "multiplier")
    return Mimic(str(mimic.get("joint", "")), multiplier, number(mimic.get("offset", "0"), where, "offset"))


def _need(element: etree._Element, key: str, path: Path) -> str:
    value = element.get(key)
    if not value:
        raise RobotError(f"{path}: <{element.tag}> on line {element.sourceline} needs a {key}")
    return str(value)
