"""Triangles of the shapes: one mesh for each material, no finer than a picture shows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.viewers.scene.collada import collada_asset
from cdia_pin.viewers.scene.visuals import Colour, Visual

if TYPE_CHECKING:
    import trimesh

Array = NDArray[np.float64]

GREY: Colour = (0.82, 0.83, 0.85)  # of a shape without a colour
CREASE = np.radians(32.0)  # [rad], edges sharper than this stay sharp
SEGMENTS = 48  # of a drawn circle
CROWDED = 4  # triangles over those that are wanted, beyond which a mesh is snapped to a grid first
GRID, EXACT = 250, 1e-6  # cells along such a mesh; [m], below which vertices are one
CARE, NEAR = (
    (3.0, 7.0),
    1.1,
)  # of thinning, gentle at first and then less so; [1], how near to what is wanted will do


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles of one colour.

    Attributes:
        vertices: Positions [m], shape (V, 3).
        triangles: Indices of vertices, shape (T, 3).
        colour: Red, green and blue [0, 1].
    """

    vertices: Array
    triangles: NDArray[np.int64]
    colour: Colour

    def moved(self, placement: Array) -> Mesh:
        """Return the mesh at another place.

        Args:
            placement: Homogeneous, shape (4, 4) [1, m].
        """
        at = self.vertices @ placement[:3, :3].T + placement[:3, 3]
        mirrored = np.linalg.det(placement[:3, :3]) < 0
        return Mesh(at, self.triangles[:, ::-1] if mirrored else self.triangles, self.colour)

    @property
    def extent(self) -> float:
        """Diagonal of the bounding box [m]."""
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0)))


def load_mesh(path: Path) -> list[Mesh]:
    """Read a mesh file: one mesh for each of its materials, in its own axes and in metres.

    Args:
        path: The file.

    Raises:
        Exception: Whatever the reader of a broken file raises.
    """
    import trimesh

    scene = trimesh.load_scene(path, process=False)
    scale = np.diag([*3 * [collada_asset(path).unit], 1.0])
    meshes = []
    for node in scene.graph.nodes_geometry:
        placement, name = scene.graph[node]
        part = scene.geometry[name]
        if isinstance(part, trimesh.Trimesh) and len(part.faces):
            mesh = Mesh(np.asarray(part.vertices, float), np.asarray(part.faces, np.int64), _colour_of(part))
            meshes.append(mesh.moved(scale @ placement))
    return by_colour(meshes)


def drawn(visual: Visual) -> Mesh:
    """Return the triangles of a box, cylinder, sphere or capsule.

    Args:
        visual: The shape; its axes are those of URDF.
    """
    from trimesh import creation

    size = visual.size
    if visual.kind == "box":
        shape = creation.box(extents=size)
    elif visual.kind == "sphere":
        shape = creation.icosphere(subdivisions=3, radius=size[0])
    elif visual.kind == "capsule":
        shape = creation.capsule(height=size[1], radius=size[0], count=[SEGMENTS // 2, SEGMENTS])
        shape.apply_translation([0, 0, -shape.bounds.mean(axis=0)[2]])
    else:
        shape = creation.cylinder(radius=size[0], height=size[1], sections=SEGMENTS)
    return Mesh(np.asarray(shape.vertices), np.asarray(shape.faces, np.int64), visual.colour or GREY)


def by_colour(meshes: Iterable[Mesh]) -> list[Mesh]:
    """Join meshes of the same colour.

    Args:
        meshes: In any order.

    Returns:
        One mesh for each colour, in the order in which the colours appear.
    """
    groups: dict[Colour, list[Mesh]] = {}
    for mesh in meshes:
        groups.setdefault(tuple(round(c, 2) for c in mesh.colour), []).append(mesh)  # type: ignore[arg-type]
    out = []
    for colour, group in groups.items():
        first = np.cumsum([0, *(len(m.vertices) for m in group)])
        triangles = [m.triangles + k for m, k in zip(group, first, strict=False)]
        out.append(Mesh(np.concatenate([m.vertices for m in group]), np.concatenate(triangles), colour))
    return out


def simplified(mesh: Mesh, most: int) -> Mesh:
    """Return a mesh with fewer triangles; its vertices are shared except along sharp edges.

    Args:
        mesh: The mesh.
        most: About how many triangles it may have.
    """
    import fast_simplification
    import trimesh

    crowded = (
        len(mesh.triangles) > CROWDED * most
    )  # threads and text: thinning alone does not get rid of them
    grid = mesh.extent / GRID if crowded else EXACT
    shape = trimesh.Trimesh(np.round(mesh.vertices / grid) * grid, mesh.triangles, process=False)
    shape.merge_vertices(merge_tex=True, merge_norm=True)
    shape.update_faces(shape.nondegenerate_faces() & shape.unique_faces())
    for care in CARE:
        if len(shape.faces) <= NEAR * most:
            break
        vertices, faces = fast_simplification.simplify(
            shape.vertices, shape.faces, target_count=most, agg=care
        )
        shape = trimesh.Trimesh(vertices, faces, process=False)
        shape.update_faces(shape.nondegenerate_faces())
    shape = trimesh.graph.smooth_shade(shape, angle=CREASE, facet_minarea=None)
    shape.remove_unreferenced_vertices()
    return Mesh(np.asarray(shape.vertices), np.asarray(shape.faces, np.int64), mesh.colour)


def _colour_of(part: trimesh.Trimesh) -> Colour:
    """Return the colour of a part: of its material, or the mean of its vertices or texture."""
    visual: Any = part.visual
    if not visual.defined:
        return GREY
    colour = visual.material.main_color if visual.kind == "texture" else visual.main_color
    red, green, blue = (float(c) / 255 for c in np.asarray(colour)[:3])
    return red, green, blue


def shares(meshes: Iterable[Mesh], budget: int) -> Iterator[int]:
    """Divide a budget of triangles: larger parts get more, none gets more than it has.

    Args:
        meshes: The parts.
        budget: Triangles for all of them.
    """
    given = list(meshes)
    size = np.array([m.extent for m in given])
    have = np.array([len(m.triangles) for m in given], float)
    take = np.zeros(len(given))
    for _ in range(20):  # what a small part leaves goes to the others
        open_ = take < have
        left = budget - take.sum()
        if not open_.any() or left < 1:
            break
        take[open_] += left * size[open_] / max(size[open_].sum(), 1e-12)
        take = np.minimum(take, have)
    return (max(int(t), 60) for t in take)
