"""Collisions of an arm with itself and with a floor, from the URDF's collision shapes.

Neighbouring links touch at their joint, and shapes that overlap in every posture are drawn too large: such pairs
are left out. The surroundings of the arm are not in a URDF and are not known here.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin
from lxml import etree
from numpy.typing import ArrayLike, NDArray

from cdia_pin.errors import RobotError
from cdia_pin.phrases import shortened
from cdia_pin.robot.model import RobotModel
from cdia_pin.robot.parser_input import parser_input
from cdia_pin.robot.urdf import read_urdf
from cdia_pin.robot.urdf_edit import text_of
from cdia_pin.robot.urdf_values import pose_of, size_of, welded

Array = NDArray[np.float64]

FLOOR = "floor"
TRIED = 100  # [postures], random ones in which pairs of shapes are tried
ALWAYS = 0.95  # [1], share of these postures in which a pair must touch to count as overlapping
FINE = (
    1000  # [vertices]; a finer mesh is replaced by its convex hull, which contains it and is 100 times faster
)
DEEP = 50.0  # [m], depth of the floor's box; more than the reach of any arm


@dataclass(frozen=True)
class Contact:
    """Two shapes that are closer than the clearance.

    Attributes:
        sample: Index of the posture in the trajectory.
        shapes: Names of the shapes: a link's name with a number, or ``floor``.
    """

    sample: int
    shapes: tuple[str, str]


class CollisionModel:
    """The arm's collision shapes, and the pairs of them that must not touch.

    Args:
        robot: The arm.
        clearance: Distance that pairs must keep [m]; pairs that are always nearer must only not touch.
        floor: Height of a floor above the base's origin, against gravity [m]; None for no floor.
        srdf: File whose ``<disable_collisions>`` pairs are left out too; None for no file.

    Raises:
        RobotError: If the clearance is negative, or the shapes of the URDF or the SRDF cannot be read.
    """

    def __init__(
        self,
        robot: RobotModel,
        *,
        clearance: float = 0.0,
        floor: float | None = None,
        srdf: Path | None = None,
    ) -> None:
        if not 0 <= clearance < np.inf:
            raise RobotError(f"a clearance is 0 m or more, given {clearance:g}")
        self.robot = robot
        self._model = robot.pinocchio_model
        self._data = self._model.createData()
        self._shapes = _shapes(robot)
        if floor is not None:
            self._shapes.addGeometryObject(_slab(_up(robot), floor))
        self._pair()
        if srdf is not None:
            self._disable(srdf)
        self._found = self._shapes.createData()
        overlapping = [k for k in self._usual_contacts() if FLOOR not in self._names(k)]
        self.left_out = tuple(self._names(k) for k in overlapping)
        self._remove([self._pair_of(k) for k in overlapping])
        self._found = self._shapes.createData()
        if clearance:
            self._keep(clearance)
            for k in self._usual_contacts():
                self._found.collisionRequests[k].security_margin = 0.0

    def __repr__(self) -> str:
        return f"CollisionModel({shortened(self.robot.name)}, {len(self.pairs)} pairs of shapes)"

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Names of the pairs of shapes that are checked."""
        return tuple(self._names(k) for k in range(len(self._shapes.collisionPairs)))

    def first_contact(self, q: ArrayLike) -> Contact | None:
        """Find the first posture in which two shapes are too close.

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).

        Returns:
            The sample and the two shapes; None if no posture has a contact.
        """
        for sample, posture in enumerate(np.atleast_2d(np.asarray(q, float))):
            if self._touches(posture, first=True):
                return Contact(sample, self._names(next(self._touching())))
        return None

    # ------------------------------------------------------------- internals

    def _pair(self) -> None:
        """Pair all shapes except those of one link or of neighbouring links."""
        parents = list(self._model.parents)
        joints = [shape.parentJoint for shape in self._shapes.geometryObjects]
        self._shapes.addAllCollisionPairs()
        pairs = [self._pair_of(k) for k in range(len(self._shapes.collisionPairs))]
        self._remove(
            [(i, j) for i, j in pairs if parents[joints[i]] == joints[j] or parents[joints[j]] == joints[i]]
        )

    def _disable(self, srdf: Path) -> None:
        if not srdf.is_file():
            raise RobotError(f"no such SRDF file: {srdf}")
        try:
            pin.removeCollisionPairs(self._model, self._shapes, str(srdf))
        except (ValueError, RuntimeError) as error:
            raise RobotError(f"{srdf}: Pinocchio cannot read this SRDF ({error})") from None

    def _remove(self, pairs: Iterable[tuple[int, int]]) -> None:
        for pair in pairs:
            self._shapes.removeCollisionPair(pin.CollisionPair(*pair))

    def _pair_of(self, k: int) -> tuple[int, int]:
        pair = self._shapes.collisionPairs[k]
        return int(pair.first), int(pair.second)

    def _keep(self, clearance: float) -> None:
        for request in self._found.collisionRequests:
            request.security_margin = clearance

    def _usual_contacts(self) -> list[int]:
        """Return the indices of the pairs that touch in nearly all postures."""
        lower, upper = self.robot.limits.usual_range(self.robot.is_prismatic)
        counts = np.zeros(len(self._shapes.collisionPairs))
        for posture in np.random.default_rng(0).uniform(lower, upper, (TRIED, self.robot.n)):
            if self._touches(posture, first=False):
                counts[list(self._touching())] += 1
        return [int(k) for k in np.flatnonzero(counts >= ALWAYS * TRIED)]

    def _touches(self, posture: Array, *, first: bool) -> bool:
        (c,) = self.robot.configurations(posture[None])
        return bool(pin.computeCollisions(self._model, self._data, self._shapes, self._found, c, first))

    def _touching(self) -> Iterator[int]:
        return (k for k, r in enumerate(self._found.collisionResults) if r.isCollision())

    def _names(self, k: int) -> tuple[str, str]:
        one, two = (str(self._shapes.geometryObjects[i].name) for i in self._pair_of(k))
        return one, two


def _slab(up: Array, height: float) -> pin.GeometryObject:
    """Make a floor: a box, because a mesh is tested against a half-space triangle by triangle."""
    turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), up).toRotationMatrix()
    at = pin.SE3(turn, (height - DEEP / 2) * up)
    return pin.GeometryObject(FLOOR, 0, at, coal.Box(2 * DEEP, 2 * DEEP, DEEP))


def standing_height(robot: RobotModel) -> float | None:
    """Find the height of the plane on which an arm stands: that of the lowest point of its fixed shapes.

    Args:
        robot: The arm.

    Returns:
        Height above the base's origin, against gravity [m]; None without gravity, or if the base has no shape.
    """
    if not robot.gravity_vector.any():
        return None
    below = coal.Halfspace(_up(robot), -DEEP)
    heights = []
    for shape in _shapes(robot).geometryObjects:
        if shape.parentJoint == 0:
            at = coal.Transform3s(shape.placement.rotation, shape.placement.translation)
            result = coal.DistanceResult()
            gap = coal.distance(below, coal.Transform3s(), shape.geometry, at, coal.DistanceRequest(), result)
            heights.append(float(gap) - DEEP)
    return min(heights, default=None)


def _up(robot: RobotModel) -> Array:
    """Return the unit vector against gravity in the base frame [1], shape (3,); z without gravity."""
    g = robot.gravity_vector
    return -g / np.linalg.norm(g) if g.any() else np.array([0.0, 0.0, 1.0])


def _require_readable(link: etree._Element, where: str) -> None:
    """Refuse a shape that the parser would leave out in silence: the arm could move into it."""
    for collision in link.findall("collision"):
        shape = collision.find("geometry/*")
        if shape is None:
            raise RobotError(f"{where} needs a <geometry> with a shape in it")
        pose_of(collision.find("origin"), where)
        size_of(shape, where)
        if shape.tag == "mesh" and not shape.get("filename"):
            raise RobotError(f"{where}: a mesh needs a filename")


def _shapes(robot: RobotModel) -> pin.GeometryModel:
    held = {name: joint.position for name, joint in robot.locked.items()}
    urdf = read_urdf(robot.urdf)
    for link, element in urdf.links.items():
        _require_readable(element, f"{robot.urdf.name}: link '{link}': its collision shape")
    text = text_of(welded(parser_input(urdf.tree, shapes=True), held))
    folders = [str(p) for p in robot.package_dirs]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pinocchio warns about its own argument conversion
            shapes = pin.buildGeomFromUrdfString(
                robot.pinocchio_model, text, pin.GeometryType.COLLISION, None, folders
            )
    except (ValueError, RuntimeError) as error:
        said = " ".join(str(error).split())
        raise RobotError(f"{robot.urdf.name}: its collision shapes cannot be read ({said})") from None
    for shape in shapes.geometryObjects:
        mesh = shape.geometry
        if isinstance(mesh, coal.BVHModelBase) and mesh.num_vertices > FINE:
            mesh.buildConvexHull(True, "Qt")
            shape.geometry = mesh.convex
    return shapes
