r"""The dynamics of an arm with terms: one class for the true plant, the nominal and the improved model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.dynamics.model_terms import ModelTerms
from cdia_pin.dynamics.torques import Torques
from cdia_pin.effects import Channel, Signal, State, Term
from cdia_pin.effects.memory import Memory
from cdia_pin.effects.state import DEFAULT_SIGN_WIDTH
from cdia_pin.errors import ModelError
from cdia_pin.logs.torque_side import TorqueSide, side_of_all

Array = NDArray[np.float64]

SMALLEST_GAIN = 0.05  # [1], lower bound of 1 + ∂f/∂τ: an arm with less torque cannot be driven
MOST_DIVISIONS = 20  # divisions to solve for the torque; effects in proportion to it need one and a check
SOLVED = 1e-9  # [1], change of the torque over the largest torque at which the divisions stop


@dataclass(frozen=True, repr=False)
class Dynamics(ModelTerms):
    r"""Dynamics of an arm, :math:`M \ddot q + \mathrm{nle} = \tau + \sum \beta \Phi \theta`.

    Attributes:
        robot: The rigid bodies of the URDF.
        terms: Terms Σ β Φ θ that are added to them.
        learned_from: Conditioned logs that the terms were fitted to, if any; later logs are compared with them.
    """

    @property
    def torque_side(self) -> TorqueSide:
        """Side of the gear on which the logs were measured that the terms were fitted to, as far as it is known."""
        return side_of_all(motion.torque_side for motion in self.learned_from)

    # ------------------------------------------------------------- torques

    def true_state(self, x: State) -> State:
        """Return the true state: at the true positions and under the true gravity.

        Args:
            x: The state as the encoders read it, N samples.

        Returns:
            The state with shifted positions and changed gravity.
        """
        shifting = self.on(Channel.POSITION_READING)
        return self.under_gravity(x.with_position(x.q + sum(t.shift(x) for t in shifting)) if shifting else x)

    def under_gravity(self, x: State) -> State:
        """Return the state under the gravity that acts on the arm.

        Args:
            x: The state, N samples.

        Returns:
            The state with changed gravity.
        """
        return x.with_gravity_change(self.gravity_change(x)) if self.turns_gravity else x

    def missing_torque(self, x: State) -> Array:
        """Compute f = Σ β Φ θ.

        Args:
            x: The state as it is read, with its actuator torque, N samples.

        Returns:
            f [N·m or N], shape (N, n).
        """
        at = self.true_state(x)
        others = (t for t in self.terms if t.effect.traits.channel is not Channel.POSITION_READING)
        return x.rigid_torque - at.rigid_torque + _sum(others, at)

    def torques(self, x: State) -> Torques:
        """Solve for the actuator torque and the torque that is read, given the motion.

        Effects that depend on torque are proportional to the torque of their own joint for each of its signs. Then
        one division solves for it; otherwise divisions are repeated. Effects of the reading come last. All effects
        except those of the encoders are evaluated at the true positions.

        Args:
            x: The motion as it is read, N samples; its ``effort`` is not used.

        Returns:
            The torques, and their response to a small missing torque.
        """
        at = self.true_state(x)
        on_motion = self.on_motion
        tau = at.rigid_torque - _sum((t for t in on_motion if Signal.TORQUE not in t.depends_on), at)
        gain = np.ones_like(tau)
        driven = [t for t in on_motion if Signal.TORQUE in t.depends_on]
        if driven:
            without = _sum(driven, at.with_effort(np.zeros_like(tau)))
            load = tau = tau - without
            for _ in range(MOST_DIVISIONS):
                gained = _sum(driven, at.with_effort(tau)) - without
                share = np.divide(gained, tau, out=np.zeros_like(tau), where=tau != 0)
                gain = np.maximum(1.0 + share, SMALLEST_GAIN)
                before, tau = tau, load / gain
                if np.abs(tau - before).max() <= SOLVED * np.abs(tau).max():
                    break
        return Torques(tau, self.read(x, tau[:, :, None])[:, :, 0], gain)

    def read(self, x: State, torques: Array) -> Array:
        """Return what a log reads of several torques, or of small changes of them [N·m or N], shape (N, n, k).

        Args:
            x: The motion as it is read, N samples; its ``effort`` is not used.
            torques: Torques of the actuators [N·m or N], shape (N, n, k).
        """
        return sum((-t.torques(x, torques) for t in self.on(Channel.TORQUE_READING)), start=torques)

    def inverse_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        time: ArrayLike | None = None,
        sign_width: ArrayLike = DEFAULT_SIGN_WIDTH,
    ) -> Array:
        """Compute the torque reading that the model predicts for a motion.

        Args:
            q: Positions [rad or m], shape (n,) or (N, n).
            v: Velocities [rad/s or m/s], shape of q.
            a: Accelerations [rad/s² or m/s²], shape of q.
            time: Time [s], scalar or shape (N,); zero if omitted.
            sign_width: Speed below which sgn q̇ is smoothed [rad/s or m/s], scalar or shape (n,).

        Returns:
            Torques [N·m or N], shape of q.
        """
        x = State.of(self.robot, q, v, a, time=time, sign_width=sign_width)
        reading = self.torques(x).reading
        return reading[0] if np.ndim(q) == 1 else reading

    def forward_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        time: float = 0.0,
        sign_width: ArrayLike = DEFAULT_SIGN_WIDTH,
        memory: Mapping[Memory, Array] | None = None,
    ) -> Array:
        """Compute the acceleration of one sample under an actuator torque.

        Every effect is affine in q̈: its torque at zero and at each unit acceleration gives the inertia with all
        terms. Effects of the torque reading do not act on the motion.

        Args:
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).
            tau: Actuator torques [N·m or N], shape (n,).
            time: Time [s].
            sign_width: Speed below which sgn q̇ is smoothed [rad/s or m/s], scalar or shape (n,).
            memory: States of effects with memory, from `memory` and `remembered`; initial ones if omitted.

        Returns:
            Accelerations [rad/s² or m/s²], shape (n,).

        Raises:
            ModelError: If the inertia is singular, for example because of a missing mass or rotor inertia.
        """
        q1, v1, tau1 = (np.asarray(s, float) for s in (q, v, tau))
        if not self.terms:
            return self.robot.forward_dynamics(q1, v1, tau1)
        still = np.zeros((1, self.robot.n))
        x = self.true_state(
            State.of(self.robot, q1, v1, still, effort=tau1, time=time, sign_width=sign_width, memory=memory)
        )
        push = tau1 + _sum(self.on_motion, x)[0]
        if not self.inertial:
            return self.robot.forward_dynamics(x.q[0], v1, push)
        try:
            bias = self.robot.nonlinear_effects(x.q[0], v1)
            return np.linalg.solve(self._inertia(x), push - bias)
        except np.linalg.LinAlgError:
            labels = ", ".join(t.label for t in self.inertial)
            raise ModelError(f"the inertia of '{self.robot.name}' with {labels} is singular") from None

    def mass_matrix(self, x: State) -> Array:
        """Compute the mass matrix with all terms, M − ∂f/∂q̈.

        Args:
            x: The state as it is read, one sample.

        Returns:
            Inertia [kg·m², kg·m or kg], shape (n, n).
        """
        return self._inertia(self.true_state(x))

    def _inertia(self, x: State) -> Array:
        """Compute M − ∂f/∂q̈ of one sample at the true positions, shape (n, n)."""
        n = self.robot.n
        M = self.robot.mass_matrix(x.q[0])
        if self.inertial:
            a = np.vstack([np.zeros(n), np.eye(n)])
            q, v, effort, time = (np.repeat(s, n + 1, axis=0) for s in (x.q, x.v, x.effort, x.time))
            f = _sum(self.inertial, replace(x, q=q, v=v, a=a, effort=effort, time=time))
            M = M - (f[1:] - f[0]).T
        return M

    def gravity_change(self, x: State) -> Array:
        """Compute the change of gravity by the terms along a motion.

        Args:
            x: The state, N samples.

        Returns:
            Change of the gravity vector in the base frame [m/s²], shape (N, 3).
        """
        return sum((t.gravity_change(x) for t in self._turning), np.zeros((len(x), 3)))

    @property
    def theta(self) -> Array:
        """Parameters of all terms, one after another, in their units, shape (P,)."""
        return np.concatenate([np.zeros(0), *(t.theta for t in self.terms)])

    # ------------------------------------------------------------- effects with memory

    @cached_property
    def memories(self) -> tuple[Memory, ...]:
        """Internal states of the terms that act on the arm, each once."""
        return tuple(dict.fromkeys(m for t in self.on_motion for m in t.effect.memories))

    def memory(self, known: Mapping[Memory, Array] | None = None) -> dict[Memory, Array]:
        """Return the state of each memory: as it is known, else the initial one, shape (m,) each.

        Args:
            known: States that are known, shape (m,) each; others begin anew.
        """
        known = known or {}
        return {m: known[m] if m in known else m.initial_state(self.robot) for m in self.memories}

    def remembered(self, x: State, dq: Array, dt: float) -> dict[Memory, Array]:
        """Return the state of each memory after a step of the motion.

        Args:
            x: One sample at the beginning of the step, with the memory there.
            dq: Motion during the step [rad or m], shape (n,).
            dt: Duration of the step [s].
        """
        return {m: m.advance(z, x, dq, dt) for m, z in self.memory(x.memory).items()}


def _sum(terms: Iterable[Term], x: State) -> Array:
    total = np.zeros_like(x.q)
    for term in terms:
        total += term.torque(x)
    return total
