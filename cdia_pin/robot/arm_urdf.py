"""The URDF of an arm alone: all joints that are locked here are fixed in the file, so that no program moves them."""

from __future__ import annotations

from pathlib import Path

from cdia_pin.phrases import counted
from cdia_pin.robot.model import RobotModel
from cdia_pin.robot.urdf import read_urdf
from cdia_pin.robot.urdf_edit import add_note, rebase_meshes, text_of, write_beside
from cdia_pin.robot.urdf_values import welded
from cdia_pin.version import __version__


def write_arm_urdf(robot: RobotModel, path: str | Path) -> Path:
    """Write the robot's URDF with its locked joints fixed at their positions.

    Links, comments, meshes and order stay. Relative mesh paths are rewritten for the new folder.

    Args:
        robot: The arm; its file is read again and is not changed.
        path: File to write.

    Returns:
        The file written.

    Raises:
        RobotError: If the file would overwrite the original, or cannot be written.
    """
    path = Path(path).expanduser()
    urdf = read_urdf(robot.urdf)
    tree = welded(urdf.tree, {name: held.position for name, held in robot.locked.items()})
    rebase_meshes(tree, urdf.path.parent, path.parent)
    fixed = counted(len(robot.locked), "joint")
    add_note(tree, f"{robot.urdf.name} with {fixed} fixed by cdia-pin {__version__}")
    return write_beside(robot.urdf, path, text_of(tree))
