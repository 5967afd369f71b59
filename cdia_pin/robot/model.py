"""A fixed-base arm: its rigid-body terms, its description, and variants of it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Self

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from cdia_pin.errors import RobotError, unknown_name
from cdia_pin.phrases import shortened
from cdia_pin.robot.joints import JointLimits, LockedJoint
from cdia_pin.robot.rigid_body_terms import RigidBodyTerms

Array = NDArray[np.float64]

TOOL_WORDS = ("tool0", "tcp", "tool", "end_effector", "eef", "ee_link")  # the best first


class RobotModel(RigidBodyTerms):
    r"""An arm of joints with one degree of freedom each, and its rigid-body dynamics.

    .. math:: M(q)\ddot q + \mathrm{nle}(q, \dot q) = \tau

    Each method takes one sample, shape (n,), or a trajectory, shape (N, n), and returns the same kind.

    Args:
        model: Pinocchio model with the unwanted joints locked already.
        name: Name under which the robot is known.
        urdf: File that the model was read from.
        tool_frame: Frame that carries a payload. If omitted, a frame of the last body that is named like a
            tool (``tool0``, ``tcp``, ...), else the last frame.
        locked: Joints of the URDF that do not move here, with their fixed position and the reason.
        package_dirs: Folders in which ``package://`` addresses of meshes resolve.
        warnings: What is doubtful in the description, one line each.

    Raises:
        RobotError: If a joint has more than one degree of freedom, or if there is no joint.
    """

    def __init__(
        self,
        model: pin.Model,
        *,
        name: str,
        urdf: Path,
        tool_frame: str | None = None,
        locked: Mapping[str, LockedJoint] | None = None,
        package_dirs: Sequence[Path] = (),
        warnings: Sequence[str] = (),
    ) -> None:
        super().__init__(model, name)
        self.urdf = urdf
        self.package_dirs = tuple(package_dirs)
        self.locked: dict[str, LockedJoint] = dict(locked or {})
        self.warnings: tuple[str, ...] = tuple(warnings)
        self.tool_frame = tool_frame or self._last_body_frame()
        if not model.existFrame(self.tool_frame):
            frames = [f.name for f in model.frames]
            raise RobotError(f"robot '{name}': " + unknown_name("tool frame", self.tool_frame, frames))
        self._tool_id = self._frame_id(self.tool_frame)

    def __repr__(self) -> str:
        return f"RobotModel({shortened(self.name)}, {self.n} joints, tool frame {shortened(self.tool_frame)})"

    # ---------------------------------------------------------------- description

    def joint_index(self, joint: str) -> int:
        """Return the column of a joint.

        Args:
            joint: Name of a joint that moves.

        Returns:
            Its place in ``joints``.

        Raises:
            RobotError: If the joint is unknown; the message gives the valid names.
        """
        try:
            return self.joints.index(joint)
        except ValueError:
            raise RobotError(unknown_name("joint", joint, self.joints)) from None

    def by_joint(self, values: Iterable[float]) -> dict[str, float]:
        """Return one number of each joint by the joint's name, for JSON.

        Args:
            values: One number per joint, shape (n,).
        """
        return dict(zip(self.joints, map(float, values), strict=True))

    @cached_property
    def limits(self) -> JointLimits:
        """Position, velocity and effort limits of the URDF.

        A speed or effort of 0 and a range of no width mean that the URDF does not state the limit.
        """
        m = self._model
        index = [m.joints[i].idx_q for i in range(1, m.njoints)]
        lower, upper = np.asarray(m.lowerPositionLimit)[index], np.asarray(m.upperPositionLimit)[index]
        unbounded = self.is_continuous | (lower >= upper)
        return JointLimits(
            lower=np.where(unbounded, -np.inf, lower),
            upper=np.where(unbounded, np.inf, upper),
            velocity=_stated(m.velocityLimit),
            effort=_stated(m.effortLimit),
        )

    @property
    def gravity_vector(self) -> Array:
        """Gravity in the base frame [m/s²], shape (3,)."""
        return np.array(self._model.gravity.linear)

    @cached_property
    def inertial_parameters(self) -> Array:
        """Inertial parameters of the moving bodies about their joint frame, shape (n, 10).

        Order: mass [kg], first moments x y z [kg·m], Ixx Ixy Iyy Ixz Iyz Izz [kg·m²].
        """
        return np.array([inertia.toDynamicParameters() for inertia in list(self._model.inertias)[1:]])

    @cached_property
    def links(self) -> dict[str, tuple[str | None, Array]]:
        """Joint that moves each link, None if no joint does, and the link's pose in its frame, shape (4, 4)."""
        bodies = [f for f in self._model.frames if f.type == pin.FrameType.BODY]
        names = (None, *self.joints)
        return {str(f.name): (names[f.parentJoint], np.array(f.placement.homogeneous)) for f in bodies}

    @property
    def total_mass(self) -> float:
        """Mass of all moving bodies [kg]."""
        return float(self.inertial_parameters[:, 0].sum())

    @cached_property
    def urdf_damping(self) -> Array:
        """``<dynamics damping>`` of each joint [N·m·s/rad or N·s/m], shape (n,); Pinocchio does not apply it."""
        return np.array(self._model.damping)

    @cached_property
    def urdf_friction(self) -> Array:
        """``<dynamics friction>`` of each joint [N·m or N], shape (n,); Pinocchio does not apply it."""
        return np.array(self._model.friction)

    # ---------------------------------------------------------------- tool

    @property
    def tool_joint(self) -> str:
        """Joint that moves the tool frame."""
        return str(self._model.names[self._model.frames[self._tool_id].parentJoint])

    @property
    def tool_placement(self) -> Array:
        """Pose of the tool frame in the frame of its joint, homogeneous [1, m], shape (4, 4)."""
        return np.array(self._model.frames[self._tool_id].placement.homogeneous)

    def tool_jacobian(self, q: ArrayLike) -> Array:
        """Compute the Jacobian of the tool frame in the axes of the base.

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).

        Returns:
            Linear rows [m/rad or 1], then angular rows [1 or rad/m], shape (6, n) or (N, 6, n).
        """
        return self._frame_jacobian(q, self._tool_id)

    def link_end_jacobians(self, q: ArrayLike) -> Array:
        """Compute the Jacobian of the far end of every link in the axes of the base: where the next joint sits.

        The far end of the link that carries the tool is the tool frame.

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).

        Returns:
            Linear rows [m/rad or 1], then angular rows [1 or rad/m], shape (n, 6, n) or (N, n, 6, n).
        """
        return self._link_jacobians(q, self._tool_id)

    # ---------------------------------------------------------------- variants

    def with_inertial_parameters(self, parameters: ArrayLike) -> Self:
        """Return the arm with other inertial parameters.

        Args:
            parameters: Shape (n, 10) or (10 n,), order and units of ``inertial_parameters``. Each mass must be
                above 0, or all ten parameters of the body must be 0. The bodies need not be physically
                consistent, as estimates may not be.

        Returns:
            A new arm; this one is not changed.
        """
        given = np.asarray(parameters, float).reshape(self.n, 10)
        model = self._model.copy()
        for i, row in enumerate(given, start=1):
            model.inertias[i] = pin.Inertia.FromDynamicParameters(row) if row.any() else pin.Inertia.Zero()
        return self._variant(model)

    def with_gravity(self, g: ArrayLike) -> Self:
        """Return the arm under another gravity.

        Args:
            g: Gravity vector in the base frame [m/s²], shape (3,).

        Returns:
            A new arm; this one is not changed.
        """
        return self._variant(self._with_gravity(np.asarray(g, float)))

    def _variant(self, model: pin.Model) -> Self:
        return type(self)(
            model,
            name=self.name,
            urdf=self.urdf,
            tool_frame=self.tool_frame,
            locked=self.locked,
            package_dirs=self.package_dirs,
            warnings=self.warnings,
        )

    # ---------------------------------------------------------------- internals

    def _last_body_frame(self) -> str:
        frames = [f for f in self._model.frames if f.type == pin.FrameType.BODY]
        last = self._model.njoints - 1
        on_last = [str(f.name) for f in frames if f.parentJoint == last]
        for word in TOOL_WORDS:
            named = [name for name in on_last if word in name.lower()]
            if named:
                return named[-1]
        return on_last[-1] if on_last else str(frames[-1].name)

    def _frame_id(self, name: str) -> int:
        """Prefer a link's frame to a joint's frame of the same name: URDF allows both."""
        if self._model.existFrame(name, pin.FrameType.BODY):
            return int(self._model.getFrameId(name, pin.FrameType.BODY))
        return int(self._model.getFrameId(name))


def _stated(limit: ArrayLike) -> Array:
    """Replace limits of 0, which the URDF does not state, by inf, shape (n,)."""
    given = np.asarray(limit, dtype=np.float64)
    return np.where(given > 0, given, np.inf)
