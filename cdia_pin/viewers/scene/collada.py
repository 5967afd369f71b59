"""Unit and up axis of a COLLADA file; trimesh ignores both."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from lxml import etree
from numpy.typing import NDArray

# Takes an axis that is said to be up to z.
TURNS = {
    "X_UP": np.array(
        [[0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
    ),
    "Y_UP": np.array(
        [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
    ),
    "Z_UP": np.eye(4),
}


class ColladaAsset(NamedTuple):
    """The head of a file.

    Attributes:
        unit: Length of its unit [m].
        upright: What turns the axis that it calls up to z, homogeneous, shape (4, 4).
    """

    unit: float
    upright: NDArray[np.float64]


@lru_cache(maxsize=512)
def collada_asset(path: Path) -> ColladaAsset:
    """Return unit and up axis of a mesh file; metres and z where it is no COLLADA file.

    Args:
        path: The mesh file.

    Raises:
        lxml.etree.XMLSyntaxError: If it is not XML.
        ValueError: If its unit is no number.
    """
    if path.suffix.lower() != ".dae":
        return ColladaAsset(1.0, TURNS["Z_UP"])
    unit, up = 1.0, "Y_UP"  # where the file says nothing
    for _, element in etree.iterparse(str(path), events=("end",), resolve_entities=False, huge_tree=True):
        tag = etree.QName(element).localname
        if tag == "unit":
            unit = float(element.get("meter", "1"))
        elif tag == "up_axis":
            up = (element.text or up).strip()
        elif tag == "asset":
            break
    return ColladaAsset(unit, TURNS.get(up, TURNS["Z_UP"]))
