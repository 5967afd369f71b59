"""Arms of one joint, which turns or slides under gravity."""

from __future__ import annotations

from pathlib import Path

KINDS = ("revolute", "continuous", "prismatic")


def write_urdf(kind: str, folder: Path) -> Path:
    """Write the URDF of an arm whose only joint is of this kind."""
    axis = "0 0.6 0.8" if kind == "prismatic" else "0 1 0"
    limit = "" if kind == "continuous" else '<limit lower="-2.5" upper="2.5" effort="60" velocity="6"/>'
    file = folder / f"one_{kind}.urdf"
    file.write_text(
        f"""<robot name="one_{kind}">
          <link name="base"/>
          <link name="arm"><inertial>
            <origin xyz="0.2 0.01 -0.1"/><mass value="2"/>
            <inertia ixx="0.02" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/>
          </inertial></link>
          <joint name="only" type="{kind}">
            <parent link="base"/><child link="arm"/><origin xyz="0 0 0.5"/><axis xyz="{axis}"/>{limit}
          </joint>
        </robot>""",
        encoding="utf-8",
    )
    return file
