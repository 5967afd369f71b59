"""Small edits of a URDF's XML that keep its comments, order and indentation."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from cdia_pin.errors import RobotError
from cdia_pin.input_files import resolved
from cdia_pin.robot.inertia import at_centre_of_mass
from cdia_pin.whole_files import write_whole

Array = NDArray[np.float64]


def write_inertial(link: etree._Element, parameters: Array) -> None:
    """Set the mass, centre of mass and inertia tensor of a link in place; the tensor in the link's axes (rpy = 0).

    Args:
        link: The ``<link>`` element; it is changed.
        parameters: Ten inertial parameters in the link's frame [kg, kg·m, kg·m²], shape (10,).
    """
    mass, com, tensor = at_centre_of_mass(parameters)
    inertial = child_of(link, "inertial")
    origin = child_of(inertial, "origin")
    origin.set("xyz", " ".join(repr(float(x)) for x in com))
    origin.set("rpy", "0 0 0")
    child_of(inertial, "mass").set("value", repr(mass))
    values = child_of(inertial, "inertia")
    for i, row in enumerate("xyz"):
        for j, column in enumerate("xyz"):
            if j >= i:
                values.set(f"i{row}{column}", repr(float(tensor[i, j])))


def child_of(parent: etree._Element, tag: str) -> etree._Element:
    """Return the child element with a tag; a missing child is added as the last one, with the usual indentation.

    Args:
        parent: The element; it may be changed.
        tag: Name of the child's tag.

    Returns:
        The child.
    """
    found = parent.find(tag)
    if found is not None:
        return found
    made = etree.SubElement(parent, tag)
    depth = sum(1 for _ in parent.iterancestors())
    before = made.getprevious()
    if before is None:
        parent.text = "\n" + "  " * (depth + 1)
        made.tail = "\n" + "  " * depth
    else:
        made.tail, before.tail = before.tail, parent.text
    return made


def lay_out(root: etree._Element, count: int) -> None:
    """Indent the last children, which were added.

    Args:
        root: The ``<robot>`` element; it is changed.
        count: Number of children that were added [1].
    """
    for element in root[-count:]:
        etree.indent(element, level=1)
        before = element.getprevious()
        if before is not None:
            before.tail = "\n  "
        element.tail = "\n"


def text_of(tree: etree._ElementTree) -> str:
    """Return the text of a file, with each comment before the robot on its own line.

    Args:
        tree: The XML.

    Returns:
        Text with a trailing newline.
    """
    root = tree.getroot()
    parts = [*reversed(list(root.itersiblings(preceding=True))), root]
    lines = [etree.tostring(part, encoding="unicode", with_tail=False) for part in parts]
    return "\n".join(['<?xml version="1.0" encoding="utf-8"?>', *lines]) + "\n"


def remove(element: etree._Element | None) -> None:
    """Remove an element, unless it is None, from its tree."""
    parent = element.getparent() if element is not None else None
    if element is not None and parent is not None:
        parent.remove(element)


def rebase_meshes(tree: etree._ElementTree, old: Path, new: Path) -> None:
    """Rewrite relative mesh paths, so that they name the same meshes from another folder.

    Args:
        tree: The XML; it is changed.
        old: Folder from which the paths hold now.
        new: Folder from which they shall hold.
    """
    here, there = resolved(old), resolved(new)
    for mesh in tree.iter("mesh", "texture"):
        name = str(mesh.get("filename", ""))
        if name and "://" not in name and not Path(name).is_absolute() and here != there:
            mesh.set("filename", os.path.relpath(here / name, there))


def write_beside(original: Path, path: str | Path, text: str) -> Path:
    """Write a URDF that was made of another one.

    Args:
        original: File that it was made of.
        path: File to write.
        text: Its text.

    Returns:
        The file written.

    Raises:
        RobotError: If the file would overwrite the original, or cannot be written.
    """
    path = Path(path).expanduser()
    if resolved(path) == resolved(original):
        raise RobotError(f"{path} is the robot's own file: give another name")
    try:
        write_whole(path, text)
    except OSError as error:
        raise RobotError(f"cannot write {path}: {error.strerror or error}") from None
    return path


def add_note(tree: etree._ElementTree, text: str) -> None:
    """Put a comment at the head of the file.

    Args:
        tree: The XML; it is changed.
        text: Text of the comment; ``--``, which XML forbids there, becomes ``-``.
    """
    while "--" in text:  # not allowed inside an XML comment
        text = text.replace("--", "-")
    tree.getroot().addprevious(etree.Comment(f" {text} "))
