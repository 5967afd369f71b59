"""The visual shapes of a URDF: each at its link, with pose and colour."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from cdia_pin.errors import RobotError
from cdia_pin.robot.model import RobotModel
from cdia_pin.robot.urdf import read_urdf
from cdia_pin.robot.urdf_values import homogeneous, number, size_of

Array = NDArray[np.float64]
Colour = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Visual:
    """A shape at a link.

    Attributes:
        link: The link.
        placement: Of the shape in the frame of the link, homogeneous, shape (4, 4) [1, m].
        kind: ``mesh``, ``box``, ``cylinder``, ``sphere`` or ``capsule``.
        size: Edges of a box, radius and length of a cylinder or capsule, radius of a sphere [m]; scale of a mesh [1].
        file: The mesh as the URDF addresses it; empty for other kinds.
        colour: Red, green and blue of the URDF's material [0, 1]; None where it states none.
    """

    link: str
    placement: Array
    kind: str
    size: tuple[float, ...]
    file: str
    colour: Colour | None


def visuals_of(robot: RobotModel) -> list[Visual]:
    """Return every visual shape of the robot's file, in its order.

    A shape that cannot be read is left out: a picture with a link less serves better than none.

    Args:
        robot: The arm.
    """
    urdf = read_urdf(robot.urdf)
    named = {m.get("name"): m for m in urdf.tree.getroot().iter("material") if m.find("color") is not None}
    out = []
    for link, element in urdf.links.items():
        where = f"{urdf.path.name}: link '{link}'"
        for visual in element.findall("visual"):
            shape = visual.find("geometry/*")
            if shape is None:
                continue
            material = visual.find("material")
            if material is not None and material.find("color") is None:
                material = named.get(material.get("name"))
            with contextlib.suppress(RobotError):
                placement, size = homogeneous(visual.find("origin"), where), size_of(shape, where)
                file = str(shape.get("filename", ""))
                out.append(Visual(link, placement, str(shape.tag), size, file, _colour(material)))
    return out


def mesh_path(robot: RobotModel, address: str) -> Path | None:
    """Return the file of a mesh address; None if there is none.

    Args:
        robot: The arm.
        address: As the URDF has it, with ``package://``, ``model://``, ``file://`` or relative.
    """
    scheme, found, rest = address.partition("://")
    if not found:
        scheme, rest = "", address
    if scheme == "file":
        return Path(rest) if Path(rest).is_file() else None
    folders = robot.package_dirs if scheme in ("package", "model") else (robot.urdf.parent,)
    candidates = [folder / rest for folder in folders]
    # A package's folder may have another name than the package, as a clone's often has.
    candidates += [folder / Path(*Path(rest).parts[1:]) for folder in folders if len(Path(rest).parts) > 1]
    return next((path for path in candidates if path.is_file()), None)


def _colour(material: etree._Element | None) -> Colour | None:
    """Return a colour; none where it cannot be read."""
    colour = None if material is None else material.find("color")
    if colour is None:
        return None
    with contextlib.suppress(RobotError, ValueError):
        parts = str(colour.get("rgba", "1 1 1 1")).split()[:3]
        red, green, blue = (number(t, "a material", "its colour") for t in parts)
        return red, green, blue
    return None
