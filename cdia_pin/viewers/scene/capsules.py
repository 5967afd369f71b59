"""A drawn arm where there are no meshes: a capsule from each joint to the next."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.robot.model import RobotModel
from cdia_pin.viewers.scene.chain import SceneJoint
from cdia_pin.viewers.scene.meshes import GREY, Mesh, drawn
from cdia_pin.viewers.scene.visuals import Visual

Array = NDArray[np.float64]

THICK = 0.045  # radius over the arm's length


def capsules(
    robot: RobotModel, chain: Sequence[SceneJoint], bare: Mapping[str | None, str]
) -> list[tuple[str, Mesh]]:
    """Draw bodies that have no shape.

    Args:
        robot: The arm.
        chain: Its joints.
        bare: Joints whose body is to be drawn, None for the base, with the link that the shape is of.

    Returns:
        Links and their meshes in the frame of the joint.
    """
    ends: dict[str | None, Array] = {j.parent: j.placement[:3, 3] for j in chain}
    ends[robot.tool_joint] = robot.tool_placement[:3, 3]
    length = sum(float(np.linalg.norm(end)) for end in ends.values()) or 1.0
    radius = THICK * length / max(1.0, np.sqrt(robot.n / 3))
    axes = {j.name: j.axis for j in chain}
    out = []
    for joint, link in bare.items():
        end = ends.get(joint, np.zeros(3))
        out.append((link, _bone(end, radius)))
        if joint is not None:  # a drum about the joint's axis shows what turns
            out.append((link, _drum(axes[joint], radius)))
    return out


def _bone(end: Array, radius: float) -> Mesh:
    reach = float(np.linalg.norm(end))
    capsule = drawn(Visual("", np.eye(4), "capsule", (0.7 * radius, reach), "", GREY))
    return capsule.moved(_along(end / reach if reach else np.array([0.0, 0.0, 1.0]), end / 2))


def _drum(axis: Array, radius: float) -> Mesh:
    drum = drawn(Visual("", np.eye(4), "cylinder", (radius, 2.2 * radius), "", GREY))
    return drum.moved(_along(axis, np.zeros(3)))


def _along(direction: Array, middle: Array) -> Array:
    """Return the pose of a shape whose z axis lies along a direction."""
    from trimesh import geometry

    align: Callable[..., Array] = geometry.align_vectors  # trimesh states no types
    placement = np.array(align([0.0, 0.0, 1.0], direction))
    placement[:3, 3] = middle
    return placement
