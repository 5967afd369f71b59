r"""The interval between two samples, with the torque that the model lacks; it drives every observer of the scheme.

The error of each observer obeys :math:`\dot e = -\gamma e + M^{-1}(\hat f - f + \eta)`, so all of them
need f − η alone. The midpoint rule gives its mean over a step to second order:

.. math:: \rho = M(\bar q) \frac{\dot q^+ - \dot q}{\Delta} + \mathrm{nle}(\bar q, \bar{\dot q}) - \tau - f_{model}

On the thesis' trajectory at 1 kHz with γ = 100 1/s a healthy SCARA's residual is then 1e-5 of the torque's RMS, in
units of torque; with explicit Euler it is 5e-3, and with an exact observer whose q̇ is frozen inside −γ(q̂̇ − q̇) 9e-2.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.diagnosis.engine_interface import BadSampleError
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import JointState, State
from cdia_pin.errors import ModelError

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class ArmSample:
    """One sample: time [s], positions [rad or m] and velocities [rad/s or m/s], shape (n,)."""

    time: float
    q: Array
    v: Array


@dataclass(frozen=True, slots=True, eq=False)
class SampleInterval:
    """The interval between two samples, evaluated at its middle.

    Attributes:
        time: End of the interval [s].
        duration: Δ [s].
        inverse_inertia: M⁻¹ [1/(kg·m²)], shape (n, n).
        missing: ρ, the torque that the model lacks [N·m or N], shape (n,).
        joints: Motion and torque of all joints, each signal of shape (n,).
    """

    time: float
    duration: float
    inverse_inertia: Array
    missing: Array
    joints: JointState


@dataclass(frozen=True)
class IntervalEvaluator:
    """Evaluates the model between samples, and rejects bad samples.

    Attributes:
        model: The healthy arm.
        sign_width: Speed below which sgn q̇ is smoothed [rad/s or m/s].
        longest: Longest interval that may be bridged [s].
    """

    model: Dynamics
    sign_width: float
    longest: float

    def sample(self, t: float, q: ArrayLike, v: ArrayLike) -> ArmSample:
        """Return a sample.

        Args:
            t: Time [s].
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).

        Raises:
            ModelError: If a shape is wrong, or as a `BadSampleError` if a number is not finite.
        """
        return ArmSample(self._time(t), self._signal("position", q), self._signal("velocity", v))

    def between(self, before: ArmSample, now: ArmSample, tau: ArrayLike) -> SampleInterval:
        """Return the interval between two samples.

        Args:
            before: The earlier sample.
            now: The later one.
            tau: Torque that acted in between [N·m or N], shape (n,).

        Raises:
            BadSampleError: If the torque is not finite, time does not increase, or the gap is too long.
        """
        effort = self._signal("torque", tau)
        duration = now.time - before.time
        if not duration > 0:
            raise BadSampleError(
                f"time must increase: a sample at {now.time:.6g} s after one at {before.time:.6g} s"
            )
        if duration > self.longest:
            raise BadSampleError(
                f"no sample for {duration:.3g} s before {now.time:.6g} s, more than the {self.longest:g} s that "
                "can be bridged: call reset() and start again"
            )
        q, v, a = 0.5 * (before.q + now.q), 0.5 * (before.v + now.v), (now.v - before.v) / duration
        M, bias = self._nominal(q, v, effort, now.time - 0.5 * duration)
        try:
            inverse = np.asarray(np.linalg.inv(M), dtype=np.float64)
        except np.linalg.LinAlgError:
            raise BadSampleError(f"the inertia of the model is singular at {now.time:.6g} s") from None
        missing = M @ a + bias - effort
        if not np.isfinite(missing).all():
            raise BadSampleError(f"the sample at {now.time:.6g} s is too large: its torque is not finite")
        return SampleInterval(now.time, duration, inverse, missing, self.state(now.time, q, v, a, effort))

    def state(self, t: float, q: Array, v: Array, a: Array, effort: Array) -> JointState:
        """Return the signals of all joints at once, as an effect's ``columns`` take them.

        Args:
            t: Time [s].
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).
            a: Accelerations [rad/s² or m/s²], shape (n,).
            effort: Torques [N·m or N], shape (n,).
        """
        return JointState(q, v, a, effort, np.tanh(v / self.sign_width), np.full(len(q), t))

    def at(self, now: ArmSample, effort: Array, v_desired: Array | None = None) -> JointState:
        """Return the signals of all joints at a sample, without acceleration.

        Args:
            now: The sample.
            effort: Torques [N·m or N], shape (n,).
            v_desired: Velocity whose sign dry friction takes [rad/s or m/s], shape (n,); the measured one if omitted.
        """
        x = self.state(now.time, now.q, now.v, np.zeros_like(now.q), effort)
        return x if v_desired is None else replace(x, sign=np.tanh(v_desired / self.sign_width))

    def _nominal(self, q: Array, v: Array, effort: Array, time: float) -> tuple[Array, Array]:
        """Return M and nle − f of the model, with the terms that act on its motion."""
        robot, terms = self.model.robot, self.model.on_motion
        if not self.model.terms:
            return robot.rigid_terms(q, v)
        x = State.of(robot, q, v, effort=effort, time=time, sign_width=self.sign_width)
        at = self.model.true_state(x)
        f = sum((term.torque(at)[0] for term in terms), np.zeros(robot.n))
        return self.model.mass_matrix(x), robot.nonlinear_effects(at.q[0], v) - f

    def _time(self, t: float) -> float:
        if not np.isfinite(t):
            raise BadSampleError(f"a sample's time must be finite, given {t}")
        return float(t)

    def _signal(self, what: str, given: ArrayLike) -> Array:
        x = np.array(given, dtype=np.float64)
        if x.shape != (self._joints[1],):
            raise ModelError(
                f"{what}: expected one number per joint, shape ({self._joints[1]},), given {x.shape}"
            )
        if not np.isfinite(x).all():
            joint = self._joints[0][int(np.argmax(~np.isfinite(x)))]
            raise BadSampleError(f"{what} of {joint} must be finite, given {x[~np.isfinite(x)][0]}")
        return x

    @cached_property
    def _joints(self) -> tuple[tuple[str, ...], int]:
        return self.model.robot.joints, self.model.robot.n
