"""A fixed-base arm and its rigid-body terms: the only file that touches Pinocchio's data.

Every position here is a joint coordinate: a continuous joint has one angle, although
Pinocchio stores its cosine and sine.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Self

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from cdia_pin.errors import RobotError, unknown_name

Array = NDArray[np.float64]

STANDARD_GRAVITY = 9.81  # [m/s²], Pinocchio's default
TOOL_WORDS = ("tool0", "tcp", "tool", "end_effector", "eef", "ee_link")  # best first


@dataclass(frozen=True)
class JointLimits:
    """Limits of every joint as the URDF states them; ``inf`` where it states none.

    Attributes:
        lower: Smallest position [rad or m], shape (n,).
        upper: Largest position [rad or m], shape (n,).
        velocity: Largest speed [rad/s or m/s], shape (n,).
        effort: Largest torque or force [N·m or N], shape (n,).
    """

    lower: Array
    upper: Array
    velocity: Array
    effort: Array


@dataclass(frozen=True)
class LockedJoint:
    """A joint of the URDF that does not move here.

    Attributes:
        position: Where it is held [rad or m].
        reason: Why it is not part of the arm.
    """

    position: float
    reason: str


class RobotModel:
    r"""Rigid-body dynamics of an arm of single-degree-of-freedom joints.

    .. math:: M(q)\ddot q + \mathrm{nle}(q, \dot q) = \tau

    Each method takes one sample, shape (n,), or a trajectory, shape (N, n), and answers in kind.

    Args:
        model: Pinocchio model with the unwanted joints locked already.
        name: Name under which the robot is known.
        urdf: File that the model was read from.
        tool_frame: Frame that carries a payload; if omitted, a frame of the last body that is named like a
            tool (``tool0``, ``tcp``, ...), else the last one.
        locked: Joints of the URDF that do not move here, with their fixed position and the reason.
        package_dirs: Where ``package://`` addresses of meshes resolve.
        warnings: What is doubtful in the description, one line each.

    Raises:
        RobotError: If a joint has more than one degree of freedom, or there is none at all.
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
        if model.nv == 0:
            raise RobotError(f"robot '{name}': no movable joint is left")
        wide = [model.names[i] for i in range(1, model.njoints) if model.joints[i].nv != 1]
        if wide:
            raise RobotError(
                f"robot '{name}': joint(s) {', '.join(wide)} have more than one degree of freedom; "
                "an arm has a fixed base and revolute, continuous or prismatic joints"
            )
        self.name = name
        self.urdf = urdf
        self.package_dirs = tuple(package_dirs)
        self.locked: dict[str, LockedJoint] = dict(locked or {})
        self.warnings: tuple[str, ...] = tuple(warnings)
        self._model = model
        self._data = model.createData()
        self.joints: tuple[str, ...] = tuple(model.names[i] for i in range(1, model.njoints))
        self.n = model.nv
        joint_types = [model.joints[i].shortname() for i in range(1, model.njoints)]
        self.is_prismatic: NDArray[np.bool_] = np.array(["JointModelP" in t for t in joint_types])
        self.is_continuous: NDArray[np.bool_] = np.array([model.joints[i + 1].nq == 2 for i in range(self.n)])
        self.tool_frame = tool_frame or self._last_body_frame()
        if not model.existFrame(self.tool_frame):
            frames = [f.name for f in model.frames]
            raise RobotError(f"robot '{name}': " + unknown_name("tool frame", self.tool_frame, frames))
        self._tool_id = self._frame_id(self.tool_frame)
        self._has_continuous = bool(self.is_continuous.any())

    # ---------------------------------------------------------------- description

    def joint_index(self, joint: str) -> int:
        """Return the column of a joint; raises RobotError with the valid names."""
        try:
            return self.joints.index(joint)
        except ValueError:
            raise RobotError(unknown_name("joint", joint, self.joints)) from None

    @cached_property
    def limits(self) -> JointLimits:
        """Position, velocity and effort limits of the URDF.

        A speed or effort of 0 and a range of no width mean that the URDF does not state the limit.
        """
        m = self._model
        index = [m.joints[i].idx_q for i in range(1, m.njoints)]
        lower, upper = np.asarray(m.lowerPositionLimit)[index], np.asarray(m.upperPositionLimit)[index]
        unbounded = self.is_continuous | (lower >= upper)
        stated = lambda x: np.where(np.asarray(x) > 0, x, np.inf)  # noqa: E731
        return JointLimits(
            lower=np.where(unbounded, -np.inf, lower),
            upper=np.where(unbounded, np.inf, upper),
            velocity=stated(m.velocityLimit),
            effort=stated(m.effortLimit),
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
        """Joint that moves each link, None if nothing does, and the link's pose in its frame, shape (4, 4)."""
        bodies = [f for f in self._model.frames if f.type == pin.FrameType.BODY]
        names = (None, *self.joints)
        return {str(f.name): (names[f.parentJoint], np.array(f.placement.homogeneous)) for f in bodies}

    @property
    def total_mass(self) -> float:
        """Mass of all moving bodies [kg]."""
        return float(self.inertial_parameters[:, 0].sum())

    @property
    def tool_joint(self) -> str:
        """Joint that moves the tool frame."""
        return str(self._model.names[self._model.frames[self._tool_id].parentJoint])

    @property
    def tool_placement(self) -> Array:
        """Pose of the tool frame in the frame of its joint, homogeneous, shape (4, 4)."""
        return np.array(self._model.frames[self._tool_id].placement.homogeneous)

    @cached_property
    def urdf_damping(self) -> Array:
        """``<dynamics damping>`` of each joint; Pinocchio does not apply it, shape (n,)."""
        return np.array(self._model.damping)

    @cached_property
    def urdf_friction(self) -> Array:
        """``<dynamics friction>`` of each joint; Pinocchio does not apply it, shape (n,)."""
        return np.array(self._model.friction)

    # ---------------------------------------------------------------- variants

    def with_inertial_parameters(self, parameters: ArrayLike) -> Self:
        """Return the arm with other inertial parameters, shape and order as ``inertial_parameters``.

        Masses must be above 0, or a body nothing at all; the rest need not be that of possible bodies, as estimates
        may not be.
        """
        given = np.asarray(parameters, float).reshape(self.n, 10)
        model = self._model.copy()
        for i, row in enumerate(given, start=1):
            model.inertias[i] = pin.Inertia.FromDynamicParameters(row) if row.any() else pin.Inertia.Zero()
        return self._variant(model)

    def with_gravity(self, g: ArrayLike) -> Self:
        """Return the arm under another gravity vector in the base frame [m/s²], shape (3,)."""
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

    # ---------------------------------------------------------------- rigid-body terms

    def mass_matrix(self, q: ArrayLike) -> Array:
        """Joint-space inertia M(q) [kg·m², kg·m or kg], shape (n, n) or (N, n, n)."""
        return self._each((self.n, self.n), lambda c: pin.crba(self._model, self._data, c), q)

    def nonlinear_effects(self, q: ArrayLike, v: ArrayLike) -> Array:
        """Coriolis, centrifugal and gravity torques nle = V + G [N·m or N], shape as q."""
        return self._each((self.n,), lambda c, w: pin.nonLinearEffects(self._model, self._data, c, w), q, v)

    def rigid_terms(self, q: Array, v: Array) -> tuple[Array, Array]:
        """M(q) and nle(q, q̇) of one sample, unchecked, for what runs once a tick; shapes (n, n) and (n,)."""
        c = self._configuration(q[None])[0] if self._has_continuous else q
        return pin.crba(self._model, self._data, c), pin.nonLinearEffects(self._model, self._data, c, v)

    def gravity(self, q: ArrayLike) -> Array:
        """Gravity torques G(q) [N·m or N], shape as q."""
        return self._each((self.n,), lambda c: pin.computeGeneralizedGravity(self._model, self._data, c), q)

    def gravity_regressor(self, q: ArrayLike) -> Array:
        """K(q) with G = K g for the gravity vector g in the base frame, shape (n, 3) or (N, n, 3)."""
        axes = [self._with_gravity(axis) for axis in np.eye(3)]
        columns = [self._each((self.n,), _gravity_of(model), q) for model in axes]
        return np.stack(columns, axis=-1)

    def inverse_dynamics(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Array:
        """Rigid-body torque M q̈ + nle [N·m or N], shape as q."""
        return self._each((self.n,), lambda c, w, b: pin.rnea(self._model, self._data, c, w, b), q, v, a)

    def forward_dynamics(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike) -> Array:
        """Acceleration M⁻¹(τ − nle) [rad/s² or m/s²], shape as q."""
        return self._each((self.n,), lambda c, w, t: pin.aba(self._model, self._data, c, w, t), q, v, tau)

    def torque_regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Array:
        """Y(q, q̇, q̈) with M q̈ + nle = Y π; π as ``inertial_parameters``, flattened.

        Returns:
            Shape (n, 10 n) or (N, n, 10 n).
        """
        return self._each(
            (self.n, 10 * self.n),
            lambda c, w, b: pin.computeJointTorqueRegressor(self._model, self._data, c, w, b),
            q,
            v,
            a,
        )

    def weight_regressor(self, q: ArrayLike) -> Array:
        """∂Y/∂g of the torque regressor, for the gravity vector g in the base frame.

        Returns:
            Shape (n, 10 n, 3) or (N, n, 10 n, 3).
        """
        still = np.zeros(self.n)
        columns = []
        for axis in np.eye(3):
            model = self._with_gravity(axis)
            weigh = partial(pin.computeJointTorqueRegressor, model, model.createData())
            columns.append(
                self._each((self.n, 10 * self.n), lambda c, weigh=weigh: weigh(c, still, still), q)
            )
        return np.stack(columns, axis=-1)

    def tool_jacobian(self, q: ArrayLike) -> Array:
        """Jacobian of the tool, linear then angular, base axes, shape (6, n) or (N, 6, n)."""

        def jacobian(c: Array) -> Array:
            axes = pin.LOCAL_WORLD_ALIGNED
            return pin.computeFrameJacobian(self._model, self._data, c, self._tool_id, axes)

        return self._each((6, self.n), jacobian, q)

    def point_mass_matrix(self, q: ArrayLike) -> Array:
        """Inertia Σ mₗ JₗᵀJₗ of the links as points at their centres of mass, shape as ``mass_matrix``."""
        model = self._points
        data = model.createData()
        return self._each((self.n, self.n), lambda c: pin.crba(model, data, c), q)

    def joint_placements(self, q: ArrayLike) -> Array:
        """Pose of every joint frame in the base frame, homogeneous, shape (n, 4, 4) or (N, n, 4, 4)."""

        def placements(c: Array) -> Array:
            pin.forwardKinematics(self._model, self._data, c)
            return np.array([m.homogeneous for m in list(self._data.oMi)[1:]])

        return self._each((self.n, 4, 4), placements, q)

    # ---------------------------------------------------------------- internals

    @cached_property
    def _points(self) -> pin.Model:
        model = self._model.copy()
        for i in range(1, model.njoints):
            body = model.inertias[i]
            model.inertias[i] = pin.Inertia(body.mass, body.lever, np.zeros((3, 3)))
        return model

    def _with_gravity(self, g: Array) -> pin.Model:
        model = self._model.copy()
        model.gravity.linear = g
        return model

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
        """A link's frame before a joint's frame of the same name: URDF allows both."""
        if self._model.existFrame(name, pin.FrameType.BODY):
            return int(self._model.getFrameId(name, pin.FrameType.BODY))
        return int(self._model.getFrameId(name))

    def _configuration(self, q: Array) -> Array:
        """Joint coordinates (N, n) to Pinocchio's configurations (N, nq)."""
        if not self.is_continuous.any():
            return q
        out = np.empty((len(q), self._model.nq))
        for j in range(self.n):
            at = self._model.joints[j + 1].idx_q
            if self.is_continuous[j]:
                out[:, at] = np.cos(q[:, j])
                out[:, at + 1] = np.sin(q[:, j])
            else:
                out[:, at] = q[:, j]
        return out

    def _each(
        self, shape: tuple[int, ...], term: Callable[..., Array], q: ArrayLike, *rest: ArrayLike
    ) -> Array:
        """Evaluate a Pinocchio term for one sample or for each sample of a trajectory."""
        signals = [np.asarray(s, dtype=np.float64) for s in (q, *rest)]
        for s in signals:
            if s.shape != signals[0].shape or s.ndim not in {1, 2} or s.shape[-1] != self.n:
                given = ", ".join(str(s.shape) for s in signals)
                raise RobotError(
                    f"robot '{self.name}': signals must share the shape ({self.n},) or (N, {self.n}), "
                    f"given {given}"
                )
        rows = [np.atleast_2d(s) for s in signals]
        rows[0] = self._configuration(rows[0])
        out = np.empty((len(rows[0]), *shape))
        for k, row in enumerate(zip(*rows, strict=True)):
            out[k] = term(*row)
        return out[0] if signals[0].ndim == 1 else out


def _gravity_of(model: pin.Model) -> Callable[[Array], Array]:
    data = model.createData()
    return lambda c: pin.computeGeneralizedGravity(model, data, c)
