r"""Rigid-body terms of an arm.

.. math:: M(q)\ddot q + \mathrm{nle}(q, \dot q) = \tau

This is the only file that evaluates dynamics with Pinocchio's data. Every position here is a joint coordinate: a
continuous joint has one angle, although Pinocchio stores its cosine and sine.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from cdia_pin.errors import RobotError

Array = NDArray[np.float64]


class RigidBodyTerms:
    """Mass matrix, bias torques, regressors and kinematics of joints with one degree of freedom each.

    Each method takes one sample, shape (n,), or a trajectory, shape (N, n), and returns the same kind.

    Args:
        model: Pinocchio model with the unwanted joints locked already.
        name: Name under which the robot is known, for messages.

    Raises:
        RobotError: If a joint has more than one degree of freedom, or if there is no joint.
    """

    def __init__(self, model: pin.Model, name: str) -> None:
        if model.nv == 0:
            raise RobotError(f"robot '{name}': no movable joint is left")
        wide = [model.names[i] for i in range(1, model.njoints) if model.joints[i].nv != 1]
        if wide:
            raise RobotError(
                f"robot '{name}': joints that have more than one degree of freedom: {', '.join(wide)}; "
                "an arm has a fixed base and revolute, continuous or prismatic joints"
            )
        self.name = name
        self.joints: tuple[str, ...] = tuple(model.names[i] for i in range(1, model.njoints))
        self.n: int = model.nv
        joint_types = [model.joints[i].shortname() for i in range(1, model.njoints)]
        self.is_prismatic: NDArray[np.bool_] = np.array(["JointModelP" in t for t in joint_types])
        self.is_continuous: NDArray[np.bool_] = np.array([model.joints[i + 1].nq == 2 for i in range(self.n)])
        self._has_continuous = bool(self.is_continuous.any())
        self._starts = np.array([model.joints[i + 1].idx_q for i in range(self.n)])
        self._sines = self._starts[self.is_continuous] + 1
        self._model = model
        self._data = model.createData()

    @property
    def pinocchio_model(self) -> pin.Model:
        """Pinocchio's model of the arm, for files of this folder that need its geometry; do not change it."""
        return self._model

    def configurations(self, q: Array) -> Array:
        """Convert joint coordinates to Pinocchio's configurations.

        Args:
            q: Positions [rad or m], shape (N, n).

        Returns:
            Shape (N, nq): a continuous joint takes two columns, the cosine and the sine of its angle [1].
        """
        if not self._has_continuous:
            return q
        out = np.empty((len(q), self._model.nq))
        out[:, self._starts] = np.where(self.is_continuous, np.cos(q), q)
        out[:, self._sines] = np.sin(q[:, self.is_continuous])
        return out

    def _configuration(self, q: Array) -> Array:
        """Convert the joint coordinates of one sample to Pinocchio's configuration, shape (nq,)."""
        return self.configurations(q[None])[0] if self._has_continuous else q

    # ---------------------------------------------------------------- dynamics

    def mass_matrix(self, q: ArrayLike) -> Array:
        """Compute the joint-space inertia M(q).

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).

        Returns:
            M [kg·m², kg·m or kg], shape (n, n) or (N, n, n).
        """
        return self._each((self.n, self.n), lambda c: pin.crba(self._model, self._data, c), q)

    def nonlinear_effects(self, q: ArrayLike, v: ArrayLike) -> Array:
        """Compute the Coriolis, centrifugal and gravity torques nle = V + G.

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).
            v: Velocities [rad/s or m/s], shape of q.

        Returns:
            Torques [N·m or N], shape of q.
        """
        return self._each((self.n,), lambda c, w: pin.nonLinearEffects(self._model, self._data, c, w), q, v)

    def rigid_terms(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Compute M(q) and nle(q, q̇) of one sample without checks, for code that runs once per control tick.

        Args:
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).

        Returns:
            M [kg·m², kg·m or kg], shape (n, n), and nle [N·m or N], shape (n,).
        """
        c = self._configuration(q) if self._has_continuous else q
        return pin.crba(self._model, self._data, c), pin.nonLinearEffects(self._model, self._data, c, v)

    def torque(self, q: Array, v: Array, a: Array) -> Array:
        """Compute the torque of one sample as `inverse_dynamics` does, without checks.

        Args:
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).
            a: Accelerations [rad/s² or m/s²], shape (n,).

        Returns:
            Torques [N·m or N], shape (n,).
        """
        found: Array = pin.rnea(self._model, self._data, self._configuration(q), v, a)
        return found

    def acceleration(self, q: Array, v: Array, tau: Array) -> Array:
        """Compute the acceleration of one sample as `forward_dynamics` does, without checks.

        Args:
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).
            tau: Joint torques [N·m or N], shape (n,).

        Returns:
            Accelerations [rad/s² or m/s²], shape (n,).
        """
        found: Array = pin.aba(self._model, self._data, self._configuration(q), v, tau)
        return found

    def gravity(self, q: ArrayLike) -> Array:
        """Compute the gravity torques G(q).

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).

        Returns:
            Torques [N·m or N], shape of q.
        """
        return self._each((self.n,), lambda c: pin.computeGeneralizedGravity(self._model, self._data, c), q)

    def inverse_dynamics(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Array:
        """Compute the rigid-body torque M q̈ + nle of a motion.

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).
            v: Velocities [rad/s or m/s], shape of q.
            a: Accelerations [rad/s² or m/s²], shape of q.

        Returns:
            Torques [N·m or N], shape of q.
        """
        (c, w, b), one = self._rows(q, v, a)
        out = np.empty(w.shape)  # all samples in one call take half the time of one call each
        pin.rneaInParallel(1, pin.ModelPool(self._model, 1), c.T, w.T, b.T, out.T)
        return out[0] if one else out

    def forward_dynamics(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike) -> Array:
        """Compute the acceleration M⁻¹(τ − nle).

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).
            v: Velocities [rad/s or m/s], shape of q.
            tau: Joint torques [N·m or N], shape of q.

        Returns:
            Accelerations [rad/s² or m/s²], shape of q.
        """
        return self._each((self.n,), lambda c, w, t: pin.aba(self._model, self._data, c, w, t), q, v, tau)

    def point_mass_matrix(self, q: ArrayLike) -> Array:
        """Compute Σ mₗ JₗᵀJₗ: the inertia of the links as points at their centres of mass.

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).

        Returns:
            Inertia [kg·m², kg·m or kg], shape (n, n) or (N, n, n).
        """
        model = self._points
        data = model.createData()
        return self._each((self.n, self.n), lambda c: pin.crba(model, data, c), q)

    # ---------------------------------------------------------------- regressors

    def torque_regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Array:
        """Compute Y(q, q̇, q̈) with M q̈ + nle = Y π, where π is ``inertial_parameters``, flattened.

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).
            v: Velocities [rad/s or m/s], shape of q.
            a: Accelerations [rad/s² or m/s²], shape of q.

        Returns:
            Y [N·m or N per unit of π], shape (n, 10 n) or (N, n, 10 n).
        """
        return self._each(
            (self.n, 10 * self.n),
            lambda c, w, b: pin.computeJointTorqueRegressor(self._model, self._data, c, w, b),
            q,
            v,
            a,
        )

    def gravity_regressor(self, q: ArrayLike) -> Array:
        """Compute K(q) with G = K g for the gravity vector g in the base frame.

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).

        Returns:
            K [kg·m or kg], shape (n, 3) or (N, n, 3).
        """
        return np.stack([self._each((self.n,), weigh, q) for weigh in self._along_axes], axis=-1)

    def regressors(self, q: Array, v: Array, a: Array) -> tuple[Array, Array]:
        """Compute the torque regressor Y and the gravity regressor K of one sample, without checks.

        Args:
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).
            a: Accelerations [rad/s² or m/s²], shape (n,).

        Returns:
            Y [N·m or N per unit of π], shape (n, 10 n), and K [kg·m or kg], shape (n, 3).
        """
        c, K = self._configuration(q), np.empty((self.n, 3))
        for axis, weigh in enumerate(self._along_axes):
            K[:, axis] = weigh(c)
        Y = pin.computeJointTorqueRegressor(self._model, self._data, c, v, a)
        return Y if self.n > 1 else np.reshape(Y, (1, 10)), K  # Pinocchio drops the axis of a single joint

    def gravity_stiffness(self, q: ArrayLike) -> Array:
        """Compute ∂G/∂q, by which the gravity torque changes with the posture.

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).

        Returns:
            Stiffness [N·m/rad, N/rad, N·m/m or N/m], shape (n, n) or (N, n, n).
        """
        data = self._model.createData()
        return self._each(
            (self.n, self.n), partial(pin.computeGeneralizedGravityDerivatives, self._model, data), q
        )

    def weight_regressor(self, q: ArrayLike) -> Array:
        """Compute ∂Y/∂g of the torque regressor, for the gravity vector g in the base frame.

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).

        Returns:
            Shape (n, 10 n, 3) or (N, n, 10 n, 3), in the unit of Y per m/s².
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

    # ---------------------------------------------------------------- kinematics

    def joint_placements(self, q: ArrayLike) -> Array:
        """Compute the pose of every joint frame in the base frame.

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).

        Returns:
            Homogeneous matrices [1, m], shape (n, 4, 4) or (N, n, 4, 4).
        """

        def placements(c: Array) -> Array:
            pin.forwardKinematics(self._model, self._data, c)
            return np.array([m.homogeneous for m in list(self._data.oMi)[1:]])

        return self._each((self.n, 4, 4), placements, q)

    def _frame_jacobian(self, q: ArrayLike, frame: int) -> Array:
        """Jacobian of a frame, linear then angular, axes of the base, shape (6, n) or (N, 6, n)."""

        def jacobian(c: Array) -> Array:
            axes = pin.LOCAL_WORLD_ALIGNED
            return np.asarray(pin.computeFrameJacobian(self._model, self._data, c, frame, axes))

        return self._each((6, self.n), jacobian, q)

    def _link_jacobians(self, q: ArrayLike, tool: int) -> Array:
        """Jacobians of the far ends of the links, linear then angular, shape (n, 6, n) or (N, n, 6, n)."""
        model, data, axes = self._model, self._data, pin.LOCAL_WORLD_ALIGNED
        carrier = model.frames[tool].parentJoint

        def jacobians(c: Array) -> Array:
            pin.computeJointJacobians(model, data, c)
            out = np.zeros((self.n, 6, self.n))
            for i in range(1, self.n + 1):
                if i < self.n:
                    # The next joint does not move the end of this link, whatever it does to its own frame.
                    out[i - 1][:, :i] = np.reshape(pin.getJointJacobian(model, data, i + 1, axes), (6, -1))[
                        :, :i
                    ]
                if i == carrier:
                    pin.updateFramePlacement(model, data, tool)
                    out[i - 1] = np.reshape(pin.getFrameJacobian(model, data, tool, axes), (6, -1))
            return out

        return self._each((self.n, 6, self.n), jacobians, q)

    # ---------------------------------------------------------------- internals

    @cached_property
    def _points(self) -> pin.Model:
        model = self._model.copy()
        for i in range(1, model.njoints):
            body = model.inertias[i]
            model.inertias[i] = pin.Inertia(body.mass, body.lever, np.zeros((3, 3)))
        return model

    @cached_property
    def _along_axes(self) -> tuple[Callable[[Array], Array], ...]:
        """The gravity torque where gravity is one along each base axis."""
        return tuple(_gravity_of(self._with_gravity(axis)) for axis in np.eye(3))

    def _with_gravity(self, g: Array) -> pin.Model:
        model = self._model.copy()
        model.gravity.linear = g
        return model

    def _each(
        self, shape: tuple[int, ...], term: Callable[..., Array], q: ArrayLike, *rest: ArrayLike
    ) -> Array:
        """Evaluate a Pinocchio term for one sample or for each sample of a trajectory."""
        rows, one = self._rows(q, *rest)
        out = np.empty((len(rows[0]), *shape))
        if self.n == 1:  # Pinocchio drops its axis
            term = partial(_reshaped, term, shape)
        for k, row in enumerate(zip(*rows, strict=True)):
            out[k] = term(*row)
        return out[0] if one else out

    def _rows(self, q: ArrayLike, *rest: ArrayLike) -> tuple[list[Array], bool]:
        """Return Pinocchio's configurations and the other signals, one row for each sample, and whether it is one.

        Raises:
            RobotError: If the signals have other shapes.
        """
        signals = [np.asarray(s, dtype=np.float64) for s in (q, *rest)]
        for s in signals:
            if s.shape != signals[0].shape or s.ndim not in {1, 2} or s.shape[-1] != self.n:
                given = ", ".join(str(s.shape) for s in signals)
                raise RobotError(
                    f"robot '{self.name}': signals must share the shape ({self.n},) or (N, {self.n}), "
                    f"given {given}"
                )
        rows = [np.atleast_2d(s) for s in signals]
        rows[0] = self.configurations(rows[0])
        return rows, signals[0].ndim == 1


def _reshaped(term: Callable[..., Array], shape: tuple[int, ...], *row: Array) -> Array:
    return np.reshape(term(*row), shape)


def _gravity_of(model: pin.Model) -> Callable[[Array], Array]:
    data = model.createData()
    return lambda c: pin.computeGeneralizedGravity(model, data, c)
