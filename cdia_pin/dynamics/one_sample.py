"""The forward dynamics of a plant at one sample after another, quickly: what a simulation asks for at every step.

`Dynamics.forward_dynamics` evaluates effects on arrays over samples, which takes tens of microseconds for one sample.
Here the same methods of the same effects get plain numbers; terms of several joints or with a past are evaluated as
there. Bodies that the plant carries become part of the robot.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import JointEffect, JointState, Signal, State, Term, Varying
from cdia_pin.effects.memory import Memory
from cdia_pin.robot.inertia import is_physical
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

ROUNDING = 1e-9  # [1], smallest second moment of a body that the robot may carry, relative to their sum


class OneSample:
    """Forward dynamics of a plant, sample by sample.

    Args:
        plant: The plant, with the terms of its motion alone.
        width: Speed below which sgn q̇ is smoothed [rad/s or m/s], shape (n,).
    """

    def __init__(self, plant: Dynamics, width: Array) -> None:
        self._plant, self._width = plant, width
        robot = plant.robot
        self._quick: list[_JointTerm] = []
        self._inertial: list[_JointTerm] = []
        self._slow: list[Term] = []
        self._bodies: list[Term] = []
        for term in plant.on_motion:
            quick = None if plant.turns_gravity else _JointTerm.of(term, robot)
            if quick is not None:
                inertial = Signal.ACCELERATION in term.effect.traits.depends_on
                (self._inertial if inertial else self._quick).append(quick)
            elif _is_carried(term, plant):
                self._bodies.append(term)
            else:
                self._slow.append(term)
        self._whole = plant.turns_gravity or any(Signal.ACCELERATION in t.depends_on for t in self._slow)
        self._carrying: dict[tuple[float, ...], RobotModel | None] = {}
        self._shares: tuple[Array, Sequence[float]] = np.empty(0), ()

    def look_ahead(self, time: Array) -> None:
        """Evaluate the profiles of the next samples.

        Args:
            time: Their times [s], shape (K,); samples are counted in them from now on.
        """
        self._time = time.tolist()
        zero = np.zeros((len(time), self._plant.robot.n))
        x = State(self._plant.robot, zero, zero, zero, zero, time, self._width)
        for term in (*self._quick, *self._inertial):
            term.share = term.term.profile(x).tolist()
        if self._bodies:
            self._present = list(zip(*(t.profile(x).tolist() for t in self._bodies), strict=True))

    def acceleration(
        self, k: int, q: Array, v: Array, tau: Array, memory: Mapping[Memory, Array] | None = None
    ) -> Array:
        """Compute the acceleration under an actuator torque, see `Dynamics.forward_dynamics`.

        Args:
            k: Number of the sample since `look_ahead`.
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,).
            tau: Actuator torques [N·m or N], shape (n,).
            memory: States of effects with memory; initial ones if omitted.

        Returns:
            Accelerations [rad/s² or m/s²], shape (n,).

        Raises:
            ModelError: If the inertia is singular, for example because of a missing mass or rotor inertia.
        """
        robot: RobotModel | None = self._plant.robot
        if self._bodies and not self._whole:
            robot = self._robot(self._present[k])
        if self._whole or robot is None:
            return self._plant.forward_dynamics(q, v, tau, self._time[k], self._width, memory)
        push = tau
        if self._quick or self._inertial:
            push = push + self._torque(k, q, v, tau)
        if self._slow:
            x = State.of(
                self._plant.robot, q, v, effort=tau, time=self._time[k], sign_width=self._width, memory=memory
            )
            push = push + sum(t.torque(x)[0] for t in self._slow)
        if not self._inertial:
            return robot.acceleration(q, v, push)
        M, bias = robot.rigid_terms(q, v)
        M = M.copy()
        for term, rotor in zip(self._inertial, self._rotors, strict=True):
            M[term.j, term.j] -= rotor
        try:
            return np.asarray(np.linalg.solve(M, push - bias))
        except np.linalg.LinAlgError:  # said with the terms that make it so
            return self._plant.forward_dynamics(q, v, tau, self._time[k], self._width, memory)

    def _torque(self, k: int, q: Array, v: Array, tau: Array) -> Array:
        """Return the torque of the terms of one joint at rest acceleration; note that per unit of acceleration."""
        at, speed, effort = q.tolist(), v.tolist(), tau.tolist()
        sign = np.tanh(v / self._width).tolist()
        time, out = self._time[k], [0.0] * len(at)
        for term in self._quick:
            if share := term.share[k]:
                j = term.j
                out[j] += share * term.torque(at[j], speed[j], 0.0, effort[j], sign[j], time)
        self._rotors = []
        for term in self._inertial:
            j, share = term.j, term.share[k]
            still, moved = (term.torque(at[j], speed[j], a, effort[j], sign[j], time) for a in (0.0, 1.0))
            out[j] += share * still
            self._rotors.append(share * (moved - still))
        return np.array(out)

    def _robot(self, present: tuple[float, ...]) -> RobotModel | None:
        """Return the robot with the bodies that are present; None if there is no such body."""
        if present not in self._carrying:
            self._carrying[present] = carrying(self._plant.robot, self._bodies, present)
        return self._carrying[present]


def carrying(robot: RobotModel, terms: Sequence[Term], share: Sequence[float]) -> RobotModel | None:
    """Return a robot whose links carry bodies; None if a link with them is not physical.

    Args:
        robot: The arm.
        terms: Terms of bodies.
        share: How much of each is there [1].
    """
    pi = robot.inertial_parameters.copy()
    for term, there in zip(terms, share, strict=True):
        pi += there * term.effect.on_links(np.array(term.theta), robot)
    if np.array_equal(pi, robot.inertial_parameters):
        return robot
    return robot.with_inertial_parameters(pi) if all(is_physical(p, ROUNDING) for p in pi) else None


class _JointTerm:
    """A term of one joint, evaluated on numbers instead of arrays.

    Args:
        term: The term.
        effect: Its effect.
        j: The joint's index.
    """

    def __init__(self, term: Term, effect: JointEffect, j: int) -> None:
        self.term, self.j, self.share = term, j, [0.0]
        self._columns, self._theta = effect.columns, term.theta
        nothing: Any = 0.0
        self._x = JointState(nothing, nothing, nothing, nothing, nothing, nothing)
        self._signals = vars(self._x)  # written in place: a new state takes longer than most columns

    @classmethod
    def of(cls, term: Term, robot: RobotModel) -> _JointTerm | None:
        """Return a term, or None if it needs more than the numbers of its joint and the time."""
        effect, profile = term.effect, term.profile
        if not isinstance(effect, JointEffect) or effect.memories or profile.depends_on - {Signal.TIME}:
            return None
        kind = type(effect)
        if kind.torque is not JointEffect.torque or kind.of_joint is not JointEffect.of_joint:
            return None
        found = cls(term, effect, robot.joint_index(effect.joint))
        try:  # effects of users may need arrays
            found.torque(0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
        except (TypeError, ValueError, IndexError, AttributeError):
            return None
        return found

    def torque(self, q: float, v: float, a: float, effort: float, sign: float, time: float) -> float:
        """Return Φ θ [N·m or N]."""
        x = self._signals
        x["q"], x["v"], x["a"], x["effort"], x["sign"], x["time"] = q, v, a, effort, sign, time
        own = 0.0
        for column, value in zip(self._columns(self._x), self._theta, strict=True):
            own += float(column) * value
        return own


def _is_carried(term: Term, plant: Dynamics) -> bool:
    """Tell whether a term is a body that the robot can carry."""
    effect = term.effect
    return bool(
        effect.bodies
        and not isinstance(effect, Varying)
        and not plant.turns_gravity
        and not term.profile.depends_on - {Signal.TIME}
    )
