"""The bodies of an arm: every shape of its file, in the frame of the joint that moves it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.phrases import one_line
from cdia_pin.robot.model import RobotModel
from cdia_pin.viewers.scene.chain import SceneJoint
from cdia_pin.viewers.scene.collada import collada_asset
from cdia_pin.viewers.scene.meshes import Mesh, by_colour, drawn, load_mesh
from cdia_pin.viewers.scene.visuals import mesh_path, visuals_of

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SceneMesh:
    """A mesh fixed to a joint.

    Attributes:
        link: Link that it belongs to.
        joint: Joint that moves it; None for the base.
        mesh: In the frame of the joint.
    """

    link: str
    joint: str | None
    mesh: Mesh


@dataclass(frozen=True, eq=False)
class _Part:
    """A shape with its place in the frame of a joint, as its file has it and with the file's up made z."""

    link: str
    meshes: Sequence[Mesh]
    placement: Array
    upright: Array


@dataclass(frozen=True)
class ShapeNote:
    """A sentence on a shape that cannot be drawn; ``missing``: its mesh was not found."""

    text: str
    missing: bool = False


def bodies_of(robot: RobotModel, chain: Sequence[SceneJoint]) -> tuple[list[SceneMesh], list[ShapeNote]]:
    """Read an arm's meshes, one for each colour of a link.

    RViz and Pinocchio ignore the up axis that a COLLADA file states, other readers turn it to z. Where no file of a
    robot states z, the choice that puts the bodies nearest to the joints is taken.

    Args:
        robot: The arm.
        chain: Its joints.

    Returns:
        The meshes, and a note for each shape that cannot be drawn.
    """
    notes: list[ShapeNote] = []
    parts = _parts(robot, notes)
    ways = [_placed(robot, parts, np.eye(4))]
    if parts and not any(np.array_equal(p.upright, np.eye(4)) for p in parts):
        ways.append(_placed(robot, parts, None))
    return min(ways, key=lambda meshes: _gap(meshes, chain)), notes


def _parts(robot: RobotModel, notes: list[ShapeNote]) -> list[_Part]:
    parts = []
    for visual in visuals_of(robot):
        placement = robot.links[visual.link][1] @ visual.placement
        if visual.kind != "mesh":
            parts.append(_Part(visual.link, [drawn(visual)], placement, np.eye(4)))
            continue
        path = mesh_path(robot, visual.file)
        if path is None:
            notes.append(ShapeNote(f"link '{visual.link}': there is no mesh {visual.file}", missing=True))
            continue
        try:
            meshes, upright = load_mesh(path), collada_asset(path).upright
        except Exception as error:  # every format's reader raises its own
            notes.append(ShapeNote(f"link '{visual.link}': {path.name} cannot be read ({one_line(error)})"))
            continue
        if visual.colour is not None:
            meshes = [replace(m, colour=visual.colour) for m in meshes]
        parts.append(_Part(visual.link, meshes, placement @ np.diag([*visual.size, 1.0]), upright))
    return parts


def _placed(robot: RobotModel, parts: Sequence[_Part], turn: Array | None) -> list[SceneMesh]:
    """Return the meshes in their joints' frames, each turned, or upright if no turn is given."""
    links: dict[str, list[Mesh]] = {}
    for p in parts:
        at = p.placement @ (p.upright if turn is None else turn)
        links.setdefault(p.link, []).extend(m.moved(at) for m in p.meshes)
    return [SceneMesh(link, robot.links[link][0], mesh) for link in links for mesh in by_colour(links[link])]


def _gap(meshes: Sequence[SceneMesh], chain: Sequence[SceneJoint]) -> float:
    """Return how far bodies are from the joints at their two ends, summed [m]."""
    ends: dict[str | None, list[Array]] = {j.name: [np.zeros(3)] for j in chain}
    for j in chain:
        ends.setdefault(j.parent, []).append(j.placement[:3, 3])
    total = 0.0
    for joint, points in ends.items():
        vertices = [m.mesh.vertices for m in meshes if m.joint == joint]
        for point in points if vertices else ():
            total += min(float(np.linalg.norm(v - point, axis=1).min()) for v in vertices)
    return total
