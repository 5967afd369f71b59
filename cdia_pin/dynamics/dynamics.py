r"""An arm with terms added: the true plant, the nominal model and the improved model are one class."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.effects import State, Term, parse_effect
from cdia_pin.effects.state import DEFAULT_SIGN_WIDTH
from cdia_pin.errors import ModelError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

SMALLEST_GAIN = 0.05  # [1], 1 + ∂f/∂τ is kept above it when solving for the torque


@dataclass(frozen=True)
class Torques:
    """Torques of a motion [N·m or N], each of shape (N, n).

    Attributes:
        actuator: What the actuators must give.
        reading: What a log would say they gave.
        gain: 1 + ∂f/∂τ [1]; a missing torque f changes the actuator torque by −f / gain.
    """

    actuator: Array
    reading: Array
    gain: Array


@dataclass(frozen=True)
class Dynamics:
    r"""Dynamics of an arm, :math:`M \ddot q + \mathrm{nle} = \tau + \sum \beta \Phi \theta`.

    Attributes:
        robot: The rigid body as the URDF has it.
        terms: What is added to it.
    """

    robot: RobotModel
    terms: tuple[Term, ...] = ()

    def __post_init__(self) -> None:
        for term in self.terms:
            for joint in term.effect.scope:
                self.robot.joint_index(joint)

    # ------------------------------------------------------------- composing

    def add(self, *terms: Term) -> Self:
        """Return the model with terms added; a term of the same effect and scope is replaced."""
        labels = {t.label for t in terms}
        kept = tuple(t for t in self.terms if t.label not in labels)
        return type(self)(self.robot, kept + terms)

    def remove(self, label: str) -> Self:
        """Return the model without the term of that label.

        Raises:
            ModelError: If no term has it.
        """
        kept = tuple(t for t in self.terms if t.label != label)
        if len(kept) == len(self.terms):
            have = ", ".join(t.label for t in self.terms) or "none"
            raise ModelError(f"the model has no term '{label}'; its terms: {have}")
        return type(self)(self.robot, kept)

    def find(self, label: str) -> Term:
        """Return the term of that label; raises ModelError if there is none."""
        label = parse_effect(label, self.robot).label
        for term in self.terms:
            if term.label == label:
                return term
        raise ModelError(f"the model has no term '{label}'")

    # ------------------------------------------------------------- torques

    def missing_torque(self, x: State) -> Array:
        """Return f = Σ β Φ θ for a state with its actuator torque [N·m or N], shape (N, n)."""
        return _sum((t for t in self.terms), x)

    def torques(self, x: State) -> Torques:
        """Solve for the actuator torque and the torque that is read, given the motion.

        The torque-dependent effects are proportional to the torque of their own joint for either of its signs,
        so that one division solves for it; effects of the reading come last.

        Args:
            x: The motion; its ``effort`` is not used.

        Returns:
            The torques, and how a small missing torque would change them.
        """
        on_motion = [t for t in self.terms if not t.effect.reads]
        still = [t for t in on_motion if not t.effect.of_torque]
        driven = [t for t in on_motion if t.effect.of_torque]
        tau = x.rigid_torque - _sum(still, x)
        gain = np.ones_like(tau)
        if driven:
            without = _sum(driven, x.with_effort(np.zeros_like(tau)))
            load = tau - without
            gained = _sum(driven, x.with_effort(load)) - without
            share = np.divide(gained, load, out=np.zeros_like(load), where=load != 0)
            gain = np.maximum(1.0 + share, SMALLEST_GAIN)
            tau = load / gain
        reading = tau - _sum((t for t in self.terms if t.effect.reads), x.with_effort(tau))
        return Torques(tau, reading, gain)

    def inverse_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        time: ArrayLike | None = None,
        sign_width: ArrayLike = DEFAULT_SIGN_WIDTH,
    ) -> Array:
        """Return the torque reading that the model predicts for a motion [N·m or N], shape as q."""
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
    ) -> Array:
        """Return the acceleration of one sample under an actuator torque [rad/s² or m/s²], shape (n,).

        M q̈ + nle − τ − f is affine in q̈ for every effect: evaluating it at zero and at each unit acceleration
        gives the inertia with all terms included.
        """
        q1, v1, tau1 = (np.asarray(s, float) for s in (q, v, tau))
        terms = [t for t in self.terms if not t.effect.reads]
        if not terms:
            return self.robot.forward_dynamics(q1, v1, tau1)
        n = self.robot.n
        repeat = lambda s: np.broadcast_to(s, (n + 1, n))  # noqa: E731
        a = np.vstack([np.zeros(n), np.eye(n)])
        x = State.of(
            self.robot, repeat(q1), repeat(v1), a, effort=repeat(tau1), time=np.full(n + 1, time), sign_width=sign_width
        )
        balance = x.rigid_torque - repeat(tau1) - _sum(terms, x)
        mass_matrix = (balance[1:] - balance[0]).T
        return np.linalg.solve(mass_matrix, -balance[0])


def _sum(terms: Iterable[Term], x: State) -> Array:
    total = np.zeros_like(x.q)
    for term in terms:
        total += term.torque(x)
    return total
