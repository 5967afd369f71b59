"""`Scene`: what an arm looks like and how it moves, for the browser to draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin import schemas
from cdia_pin.errors import CdiaError
from cdia_pin.extras import require
from cdia_pin.robot.catalogue import STANDARD_GRAVITY
from cdia_pin.robot.model import RobotModel
from cdia_pin.viewers.scene.bodies import SceneMesh, bodies_of
from cdia_pin.viewers.scene.capsules import capsules
from cdia_pin.viewers.scene.chain import SceneJoint, chain_of
from cdia_pin.viewers.scene.meshes import shares, simplified
from cdia_pin.viewers.scene.packing import PackedMesh, packed
from cdia_pin.viewers.words import joint_units, short_names

Array = NDArray[np.float64]

HOLE = 0.02  # [m], of an arm without a shape, below which it is not filled
TRIANGLES = 60_000  # of the whole picture; a Panda then takes 1.0 MB
COARSE = 12_000  # of the picture where it moves and drawing is slow


class JointDocument(TypedDict):
    """A joint of `SceneDocument`; ``placement`` is a homogeneous matrix (4, 4), row by row."""

    name: str
    short: str
    parent: str | None
    placement: list[float]
    axis: list[float]
    kind: str
    unit: str


class MeshDocument(PackedMesh):
    """A mesh of `SceneDocument`; ``coarse`` is the same with far fewer triangles."""

    link: str
    joint: str | None
    coarse: PackedMesh


class SceneDocument(TypedDict):
    """What the browser draws: the schema ``cdia-scene/1``; ``weight`` is that of all moving bodies [N]."""

    schema: str
    robot: str
    joints: list[JointDocument]
    meshes: list[MeshDocument]
    weight: float
    home: list[float]
    noted: str
    notes: list[str]


@dataclass(frozen=True, eq=False)
class Scene:
    """What an arm looks like.

    Attributes:
        robot: The arm.
        joints: Its joints from the base on.
        meshes: What is to be seen of it, the base's first.
        coarse: The same with far fewer triangles, for where drawing is slow.
        notes: What could not be drawn as the file says, one sentence each.
        missing: How many meshes were not found.
    """

    robot: RobotModel
    joints: tuple[SceneJoint, ...]
    meshes: tuple[SceneMesh, ...]
    coarse: tuple[SceneMesh, ...]
    notes: tuple[str, ...]
    missing: int = 0

    @classmethod
    def of(cls, robot: RobotModel, *, triangles: int = TRIANGLES) -> Scene:
        """Read the shapes of an arm; where there are none, draw capsules.

        Args:
            robot: The arm.
            triangles: About how many the picture may have.

        Raises:
            MissingExtraError: If what reads meshes is not installed.
        """
        require("view", "pictures of an arm")
        chain = chain_of(robot)
        meshes, notes = bodies_of(robot, chain)
        missing = sum(note.missing for note in notes)
        said = [note.text for note in notes]
        bare = _bare(robot, chain, meshes)
        if bare:
            names = "its bodies" if len(bare) == robot.n + 1 else ", ".join(bare.values())
            said.append(f"no shapes for {names}: capsules are drawn")
            meshes += [SceneMesh(k, robot.links[k][0], m) for k, m in capsules(robot, chain, bare)]
        meshes.sort(key=lambda m: -1 if m.joint is None else robot.joints.index(m.joint))
        fine = [m for m in _simpler(meshes, triangles) if len(m.mesh.triangles)]
        return cls(robot, chain, tuple(fine), tuple(_simpler(fine, COARSE)), tuple(said), missing)

    @property
    def noted(self) -> str:
        """The notes in one short line; empty without notes."""
        if not self.missing:
            return "drawn in part" if self.notes else ""
        return f"{self.missing} mesh{'es' if self.missing > 1 else ''} missing"

    def to_dict(self, position: ArrayLike | None = None) -> SceneDocument:
        """Return the scene as the browser takes it; the same scene gives the same text.

        Args:
            position: Pose to begin with [rad or m], shape (n,); one that suits the arm if omitted.

        Raises:
            CdiaError: If the pose is not of this arm.
        """
        robot = self.robot
        home = resting_pose(robot) if position is None else _pose(robot, position)
        short = short_names(robot.joints)
        return {
            "schema": schemas.SCENE,
            "robot": robot.name,
            "joints": [
                {
                    "name": j.name,
                    "short": short[j.name],
                    "parent": j.parent,
                    "placement": [round(float(x), 10) for x in j.placement.ravel()],
                    "axis": [round(float(x), 10) for x in j.axis],
                    "kind": "prismatic" if j.prismatic else "revolute",
                    "unit": joint_units(robot, j.name)["load"],
                }
                for j in self.joints
            ],
            "meshes": [
                {"link": m.link, "joint": m.joint, **packed(m.mesh), "coarse": packed(c.mesh)}
                for m, c in zip(self.meshes, self.coarse, strict=True)
            ],
            "weight": round(STANDARD_GRAVITY * robot.total_mass, 3),
            "home": [round(float(x), 6) for x in home],
            "noted": self.noted,
            "notes": list(self.notes),
        }


def _simpler(meshes: Sequence[SceneMesh], triangles: int) -> list[SceneMesh]:
    """Return meshes that have about so many triangles together."""
    most = shares([m.mesh for m in meshes], triangles)
    return [SceneMesh(m.link, m.joint, simplified(m.mesh, t)) for m, t in zip(meshes, most, strict=True)]


def _pose(robot: RobotModel, given: ArrayLike) -> Array:
    try:
        pose = np.asarray(given, float)
    except (TypeError, ValueError):
        pose = np.empty(0)
    if pose.shape != (robot.n,) or not np.isfinite(pose).all():
        raise CdiaError(f"a pose of {robot.name} is {robot.n} finite numbers, given {given!r}")
    return pose


def resting_pose(robot: RobotModel) -> Array:
    """Return a pose that shows an arm [rad or m], shape (n,): zero, or the middle of a range that does not hold zero.

    Args:
        robot: The arm.
    """
    lower, upper = robot.limits.lower, robot.limits.upper
    bounded = np.isfinite(lower) & np.isfinite(upper)
    middle = np.where(bounded, (np.where(bounded, lower, 0) + np.where(bounded, upper, 0)) / 2, 0.0)
    inside = (lower < -0.1) & (upper > 0.1)
    return np.where(inside, 0.0, middle)


def _bare(
    robot: RobotModel, chain: Sequence[SceneJoint], meshes: Sequence[SceneMesh]
) -> dict[str | None, str]:
    """Return joints of which nothing is to be seen, with the first link that each moves."""
    first: dict[str | None, str] = {}
    for link, (joint, _) in robot.links.items():
        first.setdefault(joint, link)
    if not meshes:
        return first
    # A joint inside a wrist may move a body that nobody sees: only what leaves a hole in the arm is drawn.
    seen = {m.joint for m in meshes}
    reach = {j.parent: float(np.linalg.norm(j.placement[:3, 3])) for j in chain}
    return {j: link for j, link in first.items() if j and j not in seen and reach.get(j, 0.0) > HOLE}
