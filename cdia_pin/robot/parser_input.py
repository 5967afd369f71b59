"""What Pinocchio's parser is given of a URDF: the links with their bodies, and the joints.

The parser refuses a whole file for an odd shape, colour, calibration or version, with one message for all of them,
and writes lines of its own to the terminal. None of these is in the equation of motion.
"""

from __future__ import annotations

import copy

from lxml import etree

BODY = ("inertial",)  # of a link
SHAPES = "collision"  # of a link, where contacts are looked for
PLACE = ("origin", "parent", "child")  # of any joint
MOTION = ("axis", "limit", "dynamics")  # of a joint that moves
RANGE = ("lower", "upper")  # of a limit; a continuous joint has none


def parser_input(tree: etree._ElementTree, shapes: bool = False) -> etree._ElementTree:
    """Return the part of a URDF that makes a model of rigid bodies.

    Mimic joints are joints of their own: the rest of the package locks them.

    Args:
        tree: The URDF, checked; it is not changed.
        shapes: Whether the links keep their collision shapes.

    Returns:
        Another tree.
    """
    whole = tree.getroot()
    root = etree.Element("robot", name=str(whole.get("name")))
    for element in whole:
        if element.tag == "link":
            root.append(_part(element, ("name",), BODY))
            root[-1].extend(map(copy.deepcopy, element.findall(SHAPES) if shapes else ()))
        elif element.tag == "joint":
            fixed = element.get("type") == "fixed"
            root.append(_part(element, ("name", "type"), PLACE if fixed else PLACE + MOTION))
            _tidy(root[-1])
    return etree.ElementTree(root)


def _part(element: etree._Element, keys: tuple[str, ...], tags: tuple[str, ...]) -> etree._Element:
    """Return some attributes and the first child of some tags, which is the one that counts."""
    part = etree.Element(element.tag, {key: str(element.get(key)) for key in keys})
    part.extend(copy.deepcopy(child) for child in map(element.find, tags) if child is not None)
    return part


def _tidy(joint: etree._Element) -> None:
    """Leave out a range without a meaning, friction without a number, and spaces around numbers."""
    for tag in MOTION:
        for element in joint.findall(tag):
            for key, text in element.attrib.items():
                element.set(key, str(text).strip())
            if tag == "limit" and joint.get("type") == "continuous":
                for key in RANGE:
                    element.attrib.pop(key, None)
            if tag == "dynamics" and not {"damping", "friction"} & set(element.attrib):
                joint.remove(element)
