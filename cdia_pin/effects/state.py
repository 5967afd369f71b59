"""What an effect can see: the motion and torque of an arm over a stretch of time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.effects.rigid_motion import RigidMotion
from cdia_pin.effects.smooth_sign import smooth_sign
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

DEFAULT_SIGN_WIDTH = 1e-3  # [rad/s or m/s], sgn(v) is tanh(v / width)
ROOM_TEMPERATURE = 20.0  # [°C], of a joint whose temperature nobody measured


@dataclass(frozen=True)
class JointState:
    """One joint of a `State`; every signal has shape (N,).

    Attributes:
        q: Position [rad or m].
        v: Velocity [rad/s or m/s].
        a: Acceleration [rad/s² or m/s²].
        effort: Torque of the actuator [N·m or N], see `State.effort`.
        sign: sgn(v), smoothed to be continuous through rest [1].
        time: Time [s].
        memory: z of an effect with memory, shape (N, m); of no width for all others.
        temperature: Temperature [°C]; that of a room where nobody measured it.
    """

    q: Array
    v: Array
    a: Array
    effort: Array
    sign: Array
    time: Array
    memory: Array = field(default_factory=lambda: np.empty((0, 0)))
    temperature: Array = field(default_factory=lambda: np.array(ROOM_TEMPERATURE))

    def __repr__(self) -> str:
        return f"JointState({len(self.q)} samples)"


@dataclass(frozen=True)
class State:
    """Motion of the arm, with what several effects would otherwise compute again and again.

    Attributes:
        robot: The rigid-body model.
        q: Joint positions [rad or m], shape (N, n).
        v: Joint velocities [rad/s or m/s], shape (N, n).
        a: Joint accelerations [rad/s² or m/s²], shape (N, n).
        effort: Actuator torques [N·m or N], shape (N, n). In a simulation the commanded torque, against a
            log the torque that the model predicts: a measured torque would be a noisy regressor of itself.
        time: Time of each sample [s], shape (N,).
        sign_width: Speed below which sgn(v) is smoothed [rad/s or m/s], shape (n,).
        log: Log or condition that the motion belongs to, for effects whose parameters differ between logs.
        gravity_change: By how much gravity differs from the robot's, for bodies that are no part of it [m/s²], shape
            (N, 3); None where it does not.
        memory: z of effects with memory at the first sample, shape (m,) by effect; the initial one where it is missing.
        temperature: Temperatures of the joints [°C], shape (N, n); None where nobody measured them.
        sampled_every: Time between the samples of a motion whose torques are filtered [s]: a step of sgn(v) between
            two of them is then neither late nor early, see `smooth_sign`. 0 for sgn(v) at instants.
    """

    robot: RobotModel
    q: Array
    v: Array
    a: Array
    effort: Array
    time: Array
    sign_width: Array = field(default_factory=lambda: np.array(DEFAULT_SIGN_WIDTH))
    log: str = ""
    gravity_change: Array | None = None
    memory: Mapping[Any, Array] = field(default_factory=dict)
    temperature: Array | None = None
    sampled_every: float = 0.0

    @classmethod
    def of(
        cls,
        robot: RobotModel,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike | None = None,
        *,
        effort: ArrayLike | None = None,
        time: ArrayLike | None = None,
        sign_width: ArrayLike = DEFAULT_SIGN_WIDTH,
        memory: Mapping[Any, Array] | None = None,
    ) -> State:
        """Build a state from one sample, shape (n,), or a trajectory, shape (N, n).

        Args:
            robot: The rigid-body model.
            q: Positions [rad or m].
            v: Velocities [rad/s or m/s].
            a: Accelerations [rad/s² or m/s²]; zero if omitted.
            effort: Actuator torques [N·m or N]; those of the rigid body if omitted.
            time: Time [s], scalar or shape (N,); zero for every sample if omitted.
            sign_width: Speed below which sgn(v) is smoothed [rad/s or m/s], scalar or per joint.
            memory: z of effects with memory at the first sample, by effect; initial ones if omitted.
        """
        q2, v2 = np.atleast_2d(np.asarray(q, float)), np.atleast_2d(np.asarray(v, float))
        a2 = np.zeros_like(q2) if a is None else np.atleast_2d(np.asarray(a, float))
        tau = robot.inverse_dynamics(q2, v2, a2) if effort is None else np.atleast_2d(effort).astype(float)
        t = np.zeros(len(q2)) if time is None else np.broadcast_to(np.asarray(time, float), (len(q2),))
        width = np.broadcast_to(np.asarray(sign_width, float), (robot.n,))
        return cls(robot, q2, v2, a2, tau, t, width, memory=memory or {})

    def __len__(self) -> int:
        return len(self.q)

    def __repr__(self) -> str:
        log = f", log '{self.log}'" if self.log else ""
        return f"State({self.robot.name}, {len(self)} samples of {self.robot.n} joints{log})"

    def joint(self, name: str) -> JointState:
        """Return the signals of one joint.

        Args:
            name: Name of the joint.
        """
        j = self.robot.joint_index(name)
        x = JointState(
            self.q[:, j], self.v[:, j], self.a[:, j], self.effort[:, j], self.sign[:, j], self.time
        )
        return x if self.temperature is None else replace(x, temperature=self.temperature[:, j])

    def sample(self, k: int) -> State:
        """Return one sample as a state of its own; effects with memory are at their initial state.

        Args:
            k: Index of the sample.
        """
        return self.samples(np.s_[k : k + 1])

    def samples(self, at: slice | NDArray[np.intp]) -> State:
        """Return some samples as a state of their own; effects with memory are at their initial state.

        Args:
            at: The samples, or their indices, shape (K,).
        """
        change = None if self.gravity_change is None else self.gravity_change[at]
        q, v, a, effort, time = (s[at] for s in (self.q, self.v, self.a, self.effort, self.time))
        warmth = None if self.temperature is None else self.temperature[at]
        return replace(
            self,
            q=q,
            v=v,
            a=a,
            effort=effort,
            time=time,
            gravity_change=change,
            memory={},
            temperature=warmth,
        )

    def with_effort(self, effort: Array) -> State:
        """Return the same motion under other actuator torques, keeping what was computed for it.

        Args:
            effort: Actuator torques [N·m or N], shape (N, n).
        """
        return self._twin(effort=effort)

    def with_gravity_change(self, change: Array) -> State:
        """Return the same motion under another gravity for what is no part of the robot [m/s²], shape (N, 3).

        Args:
            change: Difference to the robot's gravity [m/s²], shape (N, 3).
        """
        return self._twin(gravity_change=change)

    def _twin(self, **changes: Array) -> State:
        _ = self.rigid  # computed once for both
        twin = replace(self, **changes)  # type: ignore[arg-type]
        twin.__dict__.update({k: v for k, v in self.__dict__.items() if k not in self.__dataclass_fields__})
        return twin

    def with_position(self, q: Array) -> State:
        """Return the same speeds and torques at other positions [rad or m], shape (N, n).

        Args:
            q: Positions [rad or m], shape (N, n).
        """
        shifted = replace(self, q=q)
        shifted.__dict__["rigid"] = self.rigid.at(q)
        return shifted

    @cached_property
    def rigid(self) -> RigidMotion:
        """What the rigid bodies need along this motion; states of the same motion share it."""
        return RigidMotion(self.robot, self.q, self.v, self.a)

    def forget(self) -> None:
        """Release what the rigid bodies need along this motion; it is computed again if it is needed."""
        self.__dict__.pop("rigid", None)

    @cached_property
    def sign(self) -> Array:
        """Smoothed sgn(v) [1], shape (N, n), see `smooth_sign`."""
        return smooth_sign(self.v, self.sign_width, self.a, self.sampled_every)

    @property
    def rigid_torque(self) -> Array:
        """M q̈ + nle of the robot as described [N·m or N], shape (N, n)."""
        return self.rigid.torque

    def body_regressor(self, joint: int) -> Array:
        """Y with M q̈ + nle = Y π for a body on a joint's link, under the gravity that it feels, shape (N, n, 10).

        Args:
            joint: Index of the joint that moves the link.
        """
        found = self.rigid.body_regressors[joint]
        if self.gravity_change is None:
            return found
        found = found.copy()
        found[:, :, :4] += np.einsum("pkng,kg->knp", self.body_weights[joint], self.gravity_change)
        return found

    def body_torque(self, joint: int, parameters: Array) -> Array:
        """Y π of a body on a joint's link, without forming Y [N·m or N], shape (N, n).

        Args:
            joint: Index of the joint that moves the link.
            parameters: π about the joint's frame [kg, kg·m, kg·m²], shape (10,).
        """
        regressor = self.rigid.body_regressors[joint]
        found = (regressor.reshape(-1, 10) @ parameters).reshape(regressor.shape[:2])  # one product, not N
        if self.gravity_change is not None:
            by_gravity = np.tensordot(parameters[:4], self.body_weights[joint], axes=1)  # (N, n, 3)
            found += np.einsum("kng,kg->kn", by_gravity, self.gravity_change)
        return found

    @property
    def body_weights(self) -> list[Array]:
        """∂Y/∂g of each link's mass and first moments, which alone have a weight, shapes (4, N, n, 3)."""
        return self.rigid.body_weights

    @property
    def gravity_regressor(self) -> Array:
        """K with G = K g, shape (N, n, 3)."""
        return self.rigid.gravity_regressor

    @cached_property
    def gravity_stiffness(self) -> Array:
        """∂G/∂q of the robot as described [N·m/rad and alike], shape (N, n, n)."""
        return self.robot.gravity_stiffness(self.q)

    @property
    def gravity(self) -> Array:
        """Gravity that bodies on the arm feel [m/s²], shape (N, 3)."""
        change = np.zeros((len(self), 3)) if self.gravity_change is None else self.gravity_change
        return self.robot.gravity_vector + change

    @property
    def tool_jacobian(self) -> Array:
        """Jacobian of the tool in base axes, shape (N, 6, n)."""
        return self.rigid.tool_jacobian

    @property
    def drag_matrix(self) -> Array:
        """Mass-weighted mean of JₗᵀJₗ at the links' centres of mass, shape (N, n, n)."""
        return self.rigid.drag_matrix
