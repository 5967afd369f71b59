"""A URDF file as a tree of links and joints, checked before Pinocchio reads it.

Pinocchio's parser reports every error with the same message, reads an invalid inertia as zero and ignores mimic
joints. The checks here name each error.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from lxml import etree

from cdia_pin.errors import RobotError
from cdia_pin.input_files import require_small_file
from cdia_pin.phrases import shortened, some
from cdia_pin.robot.urdf_values import Array, axis_of, inertial_of, number, pose_of


class JointKind(StrEnum):
    """Type of a joint, as URDF names it."""

    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    FIXED = "fixed"
    FLOATING = "floating"
    PLANAR = "planar"


MOST_JOINTS = 500  # of a file; humanoids with hands have about a hundred

MOVABLE = (JointKind.REVOLUTE, JointKind.CONTINUOUS, JointKind.PRISMATIC)
"""Kinds with one degree of freedom."""


@dataclass(frozen=True)
class Mimic:
    """The rule q = multiplier · q_followed + offset of a mimic joint.

    Attributes:
        followed: Name of the leading joint.
        multiplier: Position per position of the leader [1, m/rad or rad/m].
        offset: Position where the leader is at zero [rad or m].
    """

    followed: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class UrdfJoint:
    """A joint as its file states it.

    Attributes:
        name: Name of the joint.
        kind: Its type.
        parent: Name of the link that carries it.
        child: Name of the link that it moves.
        lower: Smallest position [rad or m]; −inf where none is stated.
        upper: Largest position [rad or m]; inf where none is stated.
        mimic: Its rule if it follows another joint.
        element: Its XML.
    """

    name: str
    kind: JointKind
    parent: str
    child: str
    lower: float
    upper: float
    mimic: Mimic | None
    element: etree._Element = field(repr=False)

    @property
    def is_movable(self) -> bool:
        """Whether the joint has a degree of freedom."""
        return self.kind is not JointKind.FIXED


@dataclass(frozen=True, repr=False)
class Urdf:
    """A parsed URDF.

    Attributes:
        path: The file.
        tree: Its XML with comments, unchanged.
        links: Link elements by name.
        joints: Joints by name, in the order of the file.
    """

    path: Path
    tree: etree._ElementTree
    links: dict[str, etree._Element]
    joints: dict[str, UrdfJoint]

    def __repr__(self) -> str:
        return f"Urdf({shortened(self.path.name)}, {len(self.links)} links, {len(self.joints)} joints)"

    @property
    def root(self) -> str:
        """Name of the link that is no joint's child."""
        children = {j.child for j in self.joints.values()}
        return next(name for name in self.links if name not in children)

    def joint_above(self, link: str) -> UrdfJoint | None:
        """Find the joint whose child is a link.

        Args:
            link: Name of the link.

        Returns:
            The joint; None for the root.
        """
        return next((j for j in self.joints.values() if j.child == link), None)

    def joints_below(self, joint: str) -> Iterator[UrdfJoint]:
        """Find every joint further out, also beyond fixed joints.

        Args:
            joint: Name of a joint.

        Yields:
            The joints that are carried by it, each before those that it carries.
        """
        waiting = [self.joints[joint].child]
        while waiting:
            link = waiting.pop(0)
            for j in self.joints.values():
                if j.parent == link:
                    yield j
                    waiting.append(j.child)

    def link_parameters(self, link: str) -> Array | None:
        """Read the inertial parameters of a link.

        Args:
            link: Name of the link.

        Returns:
            Ten parameters in the link's frame [kg, kg·m, kg·m²], shape (10,); None if the link states none.

        Raises:
            RobotError: If its ``<inertial>`` cannot be read.
        """
        return inertial_of(self.links[link], f"{self.path.name}: link '{link}'")


def parse_xml(path: Path) -> etree._ElementTree:
    """Parse a small XML file, without entities and addresses.

    Args:
        path: The file.

    Raises:
        OSError: If it cannot be read, or `require_small_file` refuses it.
        etree.XMLSyntaxError: If it is not XML.
    """
    require_small_file(path)
    # An entity or an address in a robot's file must not make this process read something else.
    return etree.parse(str(path), etree.XMLParser(resolve_entities=False, no_network=True))


def read_urdf(path: Path) -> Urdf:
    """Read and check a URDF file.

    Args:
        path: The file.

    Returns:
        Its links and joints.

    Raises:
        RobotError: If it is missing, not XML, not a URDF, or not one tree of links.
    """
    return urdf_of(_parse(path), path)


def urdf_of(tree: etree._ElementTree, path: Path) -> Urdf:
    """Check the XML of a URDF.

    Args:
        tree: The XML.
        path: The file that it is from, for messages.

    Returns:
        Its links and joints.

    Raises:
        RobotError: If it is not one tree of links.
    """
    root = tree.getroot()
    links = _by_name(root.findall("link"), path)
    joints = {name: _joint(e, path) for name, e in _by_name(root.findall("joint"), path).items()}
    if not links:
        raise RobotError(f"{path}: no <link> in this file")
    for j in joints.values():
        for role, link in (("parent", j.parent), ("child", j.child)):
            if link not in links:
                raise RobotError(
                    f"{path}: joint '{j.name}' has the {role} link '{link}', which is not defined"
                )
    if len(joints) > MOST_JOINTS:
        raise RobotError(
            f"{path}: {len(joints)} joints, an arm has {MOST_JOINTS} at most, fixed ones included"
        )
    children = [j.child for j in joints.values()]
    for link in links:
        if children.count(link) > 1:
            raise RobotError(f"{path}: link '{link}' is the child of more than one joint")
    roots = [name for name in links if name not in children]
    if len(roots) != 1:
        held = ", ".join(roots) if roots else "none"
        raise RobotError(f"{path}: a URDF has exactly one link without a parent joint, found {held}")
    _require_one_tree(path, roots[0], joints)
    urdf = Urdf(path, tree, links, joints)
    for link in links:
        urdf.link_parameters(link)  # raises with the reason; Pinocchio would read an invalid inertia as none
    return urdf


def _require_one_tree(path: Path, root: str, joints: Mapping[str, UrdfJoint]) -> None:
    """Refuse joints that nothing connects with the root, because they carry each other in a circle."""
    reached, left = {root}, list(joints.values())
    while left:
        further = [j for j in left if j.parent not in reached]
        if len(further) == len(left):
            raise RobotError(f"{path}: joints {some([j.name for j in left])} carry each other in a circle")
        reached.update(j.child for j in left if j.parent in reached)
        left = further


def _parse(path: Path) -> etree._ElementTree:
    if not path.is_file():
        raise RobotError(f"no such URDF file: {path}")
    if path.suffix == ".xacro":
        raise RobotError(f"{path}: xacro must be expanded first: xacro {path.name} > {path.stem}")
    try:
        tree = parse_xml(path)
    except etree.XMLSyntaxError as error:
        raise RobotError(f"{path}: not an XML file ({error.msg})") from None
    except OSError as error:  # also bytes that are not of the stated encoding
        raise RobotError(
            f"{path}: cannot be read ({error.strerror or 'its bytes are not of the encoding that it states'})"
        ) from None
    root = tree.getroot()
    if root.tag != "robot":
        raise RobotError(f"{path}: a URDF begins with <robot>, this file with <{root.tag}>")
    if not root.get("name"):
        raise RobotError(f"{path}: <robot> needs a name")
    return tree


def _joint(element: etree._Element, path: Path) -> UrdfJoint:
    name = _need(element, "name", path)
    where = f"{path}: joint '{name}'"
    given = element.get("type", "")
    if given not in set(JointKind):
        raise RobotError(f"{where}: unknown type '{given}'; known: {', '.join(JointKind)}")
    kind = JointKind(given)
    ends = [element.find(role) for role in ("parent", "child")]
    if any(e is None or not e.get("link") for e in ends):
        raise RobotError(f"{where}: needs <parent link=...> and <child link=...>")
    parent, child = (str(e.get("link")) for e in ends if e is not None)
    limit = element.find("limit")
    if limit is None and kind in {JointKind.REVOLUTE, JointKind.PRISMATIC}:
        raise RobotError(f"{where}: a {kind} joint needs <limit lower upper effort velocity>")
    if kind in MOVABLE:
        axis_of(element, where)
    pose_of(element.find("origin"), where)
    if kind in MOVABLE:
        _require_limits(element, where)
    lower, upper = -math.inf, math.inf
    if limit is not None and kind in {JointKind.REVOLUTE, JointKind.PRISMATIC}:
        lower, upper = (number(limit.get(k, "0"), where, f"the {k} limit") for k in ("lower", "upper"))
    return UrdfJoint(name, kind, parent, child, lower, upper, _mimic(element, where), element)


def _require_limits(joint: etree._Element, where: str) -> None:
    """Refuse an effort, a speed or a friction that is no number of 0 or more; 0 is a limit that is not known."""
    limit, dynamics = joint.find("limit"), joint.find("dynamics")
    if limit is not None:
        for key in ("effort", "velocity"):
            number(limit.get(key), where, f"the {key} limit", least=0.0)
    if dynamics is not None:
        for key in ("damping", "friction"):
            number(dynamics.get(key, "0"), where, f"the {key}", least=0.0)


def _mimic(element: etree._Element, where: str) -> Mimic | None:
    mimic = element.find("mimic")
    # PAL's files leave <mimic> on joints that they have made fixed. Such a joint does not move.
    if mimic is None or element.get("type") == "fixed":
        return None
    multiplier = number(mimic.get("multiplier", "1"), where, "multiplier")
    return Mimic(str(mimic.get("joint", "")), multiplier, number(mimic.get("offset", "0"), where, "offset"))


def _by_name(elements: Iterable[etree._Element], path: Path) -> dict[str, etree._Element]:
    found: dict[str, etree._Element] = {}
    for element in elements:
        name = _need(element, "name", path)
        if name in found:
            raise RobotError(f"{path}: two {element.tag}s are named '{name}', a name is given once")
        found[name] = element
    return found


def _need(element: etree._Element, key: str, path: Path) -> str:
    value = element.get(key)
    if not value:
        raise RobotError(f"{path}: <{element.tag}> on line {element.sourceline} needs a {key}")
    return str(value)
