"""The arm in MuJoCo: names to indices, and its rigid-body torque."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Protocol

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from benchmarks.plant.urdf import TOOL_BODY, ArmFile, LinkInertia, read_arm, write_inertia
from cdia_pin.errors import RobotError, unknown_name

Array = NDArray[np.float64]

GRAVITY = (0.0, 0.0, -9.81)  # [m/s²]
STICTION_STEPS = 4  # dry friction stops a joint within about this many steps; fewer would ring


class Editor(Protocol):
    """Whatever adds bodies or tendons to the arm before it is compiled."""

    def edit(self, spec: mujoco.MjSpec, arm: Arm) -> None:
        """Add to the specification."""


class Arm:
    """A compiled MuJoCo arm without contacts and limits; arrays are in the order of `joints`.

    Args:
        urdf: The robot's file.
        locked: Position [rad or m] of each joint that does not move.
        joints: Order of the joints; that of the file's tree if omitted.
        tool: Link that carries a payload; the last one if omitted.
        gravity: Gravity in the base frame [m/s²], shape (3,).
        editors: What is added before the model is compiled.
        step: Integration step [s]; sets how fast dry friction stops a joint.
    """

    def __init__(
        self,
        urdf: Path,
        locked: Mapping[str, float] | None = None,
        *,
        joints: Sequence[str] | None = None,
        tool: str | None = None,
        gravity: ArrayLike = GRAVITY,
        editors: Sequence[Editor] = (),
        step: float = 5e-4,
    ) -> None:
        self.file: ArmFile = read_arm(urdf, dict(locked or {}))
        spec = mujoco.MjSpec.from_string(self.file.xml)
        in_tree = [j.name for j in spec.joints]
        if not in_tree:
            raise RobotError(f"{urdf.name}: no movable joint is left")
        self.joints: tuple[str, ...] = tuple(joints or in_tree)
        if sorted(self.joints) != sorted(in_tree):
            raise RobotError(
                f"{urdf.name}: movable joints are {', '.join(in_tree)}; given {', '.join(self.joints)}"
            )
        self.n = len(self.joints)
        self.links = [b.name for b in spec.bodies][1:]
        self.tool = self._link_named(tool) if tool else self._last_link(in_tree[-1])
        self._add_massless(spec.body(self.tool), TOOL_BODY)
        for editor in editors:
            editor.edit(spec, self)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self._scratch = mujoco.MjData(self.model)
        self._configure(np.asarray(gravity, float), step)
        slide = mujoco.mjtJoint.mjJNT_SLIDE
        self.is_prismatic = np.array([self.model.joint(j).type[0] == slide for j in self.joints])
        # Column of each of MuJoCo's degrees of freedom; all joints have one, so positions are ordered alike.
        self.dofs = np.array([int(self.model.joint(j).dofadr[0]) for j in self.joints])

    def _add_massless(self, parent: mujoco.MjsBody, name: str) -> None:
        body = parent.add_body(name=name)
        body.mass, body.inertia, body.explicitinertial = 0.0, [0.0, 0.0, 0.0], True
        body.ipos, body.iquat = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]

    def _configure(self, gravity: Array, step: float) -> None:
        m = self.model
        for link in self.links:
            written = self.file.inertias.get(link, LinkInertia(0.0, np.zeros(3), np.zeros((3, 3))))
            write_inertia(m, m.body(link).id, written)
        bit = mujoco.mjtDisableBit
        m.opt.disableflags |= bit.mjDSBL_CONTACT | bit.mjDSBL_LIMIT | bit.mjDSBL_SENSOR | bit.mjDSBL_REFSAFE
        m.opt.gravity[:] = gravity
        m.opt.tolerance, m.opt.iterations, m.opt.ls_iterations = 1e-14, 50, 50
        # Dry friction as stiff as MuJoCo allows: slipping, it has its full level.
        m.dof_solimp[:, :2] = m.tendon_solimp_fri[:, :2] = 0.9999
        self.use_step(step)
        self.refresh()

    def use_step(self, step: float) -> None:
        """Set the integration step [s], and with it how fast dry friction stops a joint."""
        m = self.model
        m.opt.timestep = step
        m.dof_solref[:] = m.tendon_solref_fri[:] = [STICTION_STEPS * step, 1.0]

    def refresh(self) -> None:
        """Recompute what MuJoCo derives from masses, after they were changed."""
        mujoco.mj_setConst(self.model, self._scratch)

    # ---------------------------------------------------------------- names

    def joint_index(self, joint: str | None) -> int:
        """Return the column of a joint; raises RobotError with the valid names."""
        if joint not in self.joints:
            raise RobotError(unknown_name("joint", str(joint), self.joints))
        return self.joints.index(joint)

    def link_of(self, joint: str) -> str:
        """Return the link that a joint moves."""
        return self.file.children[self.joints[self.joint_index(joint)]]

    def bodies_of(self, joint: str) -> list[int]:
        """Return the URDF's bodies that move as one with a joint."""
        moving = self.model.body(self.link_of(joint)).id
        ids = [self.model.body(link).id for link in self.links]
        return [b for b in ids if self.model.body_weldid[b] == moving]

    def _last_link(self, joint: str) -> str:
        """Return the last link that the last joint of the tree carries."""
        after = self.links.index(self.file.children[joint])
        return self.links[after:][-1]

    def _link_named(self, frame: str) -> str:
        # A joint's frame is that of the link it moves; where both bear one name the link is meant.
        link = frame if frame in self.links else self.file.children.get(frame, frame)
        if link not in self.links:
            raise RobotError(unknown_name("tool frame", frame, self.links))
        return link

    # ---------------------------------------------------------------- dynamics

    def inverse_dynamics(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Array:
        """Torque [N·m or N] that this arm needs for a motion, passive forces included, shape as q."""
        m, d = self.model, self.data
        rows = [np.atleast_2d(np.asarray(s, float)) for s in (q, v, a)]
        out = np.empty_like(rows[0])
        for k, (qk, vk, ak) in enumerate(zip(*rows, strict=True)):
            d.qpos[self.dofs], d.qvel[self.dofs], d.qacc[self.dofs] = qk, vk, ak
            mujoco.mj_inverse(m, d)
            out[k] = d.qfrc_inverse[self.dofs]
        return out.reshape(np.shape(q))

    def mass_matrix(self, q: ArrayLike) -> Array:
        """Joint-space inertia [kg·m², kg·m or kg], shape (n, n)."""
        still, columns = np.zeros((self.n + 1, self.n)), np.vstack([np.eye(self.n), np.zeros(self.n)])
        torque = self.inverse_dynamics(np.tile(q, (self.n + 1, 1)), still, columns)
        return (torque[:-1] - torque[-1]).T
