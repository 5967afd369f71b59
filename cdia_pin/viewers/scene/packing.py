"""A mesh as text: positions in 16 bits of its bounding box, base64 of little-endian numbers."""

from __future__ import annotations

import base64
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin.viewers.scene.meshes import Mesh

STEPS = 65535  # of a position in its bounding box: 0.03 mm for a link of 2 m


class PackedMesh(TypedDict):
    """A mesh ready for JSON; ``wide`` says that indices have 32 bits, not 16."""

    colour: str
    low: list[float]
    high: list[float]
    wide: bool
    vertices: str
    triangles: str


def packed(mesh: Mesh) -> PackedMesh:
    """Return a mesh ready for JSON; ``wide`` says that indices have 32 bits, not 16."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    width = np.where(high > low, high - low, 1.0)
    steps = np.round((mesh.vertices - low) / width * STEPS).astype("<u2")
    wide = len(mesh.vertices) > STEPS
    return {
        "colour": "#" + "".join(f"{round(255 * min(max(c, 0.0), 1.0)):02x}" for c in mesh.colour),
        "low": [round(float(x), 6) for x in low],
        "high": [round(float(x), 6) for x in high],
        "wide": wide,
        "vertices": _text(steps),
        "triangles": _text(mesh.triangles.astype("<u4" if wide else "<u2")),
    }


def _text(numbers: NDArray[np.integer]) -> str:
    return base64.b64encode(np.ascontiguousarray(numbers).tobytes()).decode("ascii")
