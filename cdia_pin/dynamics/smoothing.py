r"""Smoothing of friction's sign and size of the step for a stable explicit integration.

A joint that dry friction stops within one step overshoots: it chatters by α h / m instead of resting, with
friction α, step h and inertia m. If sgn q̇ is smoothed to tanh(q̇ / w), friction at rest is a damper α / w, and
steps are stable as long as

.. math:: h\, \rho(M^{-1} A W^{-1}) < 1, \qquad A_{ij} = -\tfrac12 [f_i(\dot q_j = 0^+) - f_i(\dot q_j = 0^-)]

with ρ the spectral radius and W the diagonal matrix of the widths w. The widths here are the narrowest that keep the
left side at 0.5 along the motion. The disadvantage: below its w a joint creeps where real friction would hold it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.dynamics.trajectories import Trajectory
from cdia_pin.effects import ALWAYS, State
from cdia_pin.effects.state import DEFAULT_SIGN_WIDTH
from cdia_pin.errors import ModelError

Array = NDArray[np.float64]

STABLE = (
    0.5  # [1], target of h ρ; the limit of the integrator is 1, and the rest is a margin between postures
)
POSTURES = 12  # postures along the motion at which friction is evaluated
NUDGE = 1e-5  # [rad/s or m/s], difference of speed for derivatives
SHARP = 1e-9  # [rad/s or m/s], width at which sgn is a step compared with the nudge
LONGEST_STEP, FINEST_STEP = (
    1e-3,
    2e-4,
)  # [s], range of the step: the rate of a controller, and five times that
SMALLEST_STEP = 1e-5  # [s], a plant that needs a smaller step is refused: it would take hours
SHARP_ENOUGH = 0.005  # [1], width over largest speed that needs no smaller step


@dataclass(frozen=True, repr=False)
class Stiffness:
    """Rates at which friction acts on an arm along a motion.

    Attributes:
        dry: M⁻¹A, deceleration of each joint by dry friction [rad/s² or m/s²], shape (K, n, n).
        viscous: Largest rate ρ(M⁻¹ ∂f/∂q̇) at which friction damps a moving joint [1/s].
        speed: Largest desired speed of each joint [rad/s or m/s], shape (n,).
    """

    dry: Array
    viscous: float
    speed: Array

    def __repr__(self) -> str:
        return f"Stiffness({int(self.rough.sum())} of {len(self.speed)} joints rough, damped at {self.viscous:.3g}/s)"

    @classmethod
    def of(cls, plant: Dynamics, trajectory: Trajectory) -> Stiffness:
        """Evaluate a plant's friction along a motion, as if all its terms were always present.

        Args:
            plant: The true arm.
            trajectory: The desired motion.

        Returns:
            Rates at postures along the motion.

        Raises:
            ModelError: If the arm would have negative inertia.
        """
        robot = plant.robot
        acting = Dynamics(robot, tuple(replace(t, profile=ALWAYS) for t in plant.on_motion))
        q, v, a = trajectory(np.linspace(0.0, trajectory.duration, POSTURES + 2)[1:-1])
        moving = State.of(robot, q, v, a, sign_width=SHARP)
        moving = moving.with_effort(acting.torques(moving).actuator)
        M = np.array([acting.mass_matrix(_row(moving, k)) for k in range(POSTURES)])
        if np.linalg.eigvalsh(M + M.swapaxes(1, 2)).min() <= 0:
            inertial = ", ".join(t.label for t in acting.inertial) or "the URDF"
            raise ModelError(f"'{robot.name}' has negative inertia along the motion because of {inertial}")
        inverse = np.linalg.inv(M)
        resting = replace(moving, v=np.zeros_like(v), a=np.zeros_like(a))
        dry = inverse @ -_jump(acting, resting, -NUDGE, NUDGE) / 2
        # Sgn is flat away from rest; where a sum of speeds is near zero, one of both sides is still flat.
        away = replace(moving, v=np.where(v < 0, np.minimum(v, -3 * NUDGE), np.maximum(v, 3 * NUDGE)))
        rates = [inverse @ _jump(acting, away, *side) / NUDGE for side in ((0.0, NUDGE), (-NUDGE, 0.0))]
        viscous = np.min([_radius(r) for r in rates], axis=0).max()
        peak = np.abs(trajectory(np.linspace(0.0, trajectory.duration, 500)).v).max(axis=0)
        return cls(dry, float(viscous), peak)

    @property
    def rough(self) -> NDArray[np.bool_]:
        """True for joints with dry friction, shape (n,)."""
        return np.asarray(np.einsum("kjj->kj", self.dry).max(axis=0) > 0)

    def sign_width(self, step: float) -> Array:
        """Compute the narrowest stable smoothing of each joint's sgn q̇.

        Args:
            step: Step h of the integration [s].

        Returns:
            Widths w [rad/s or m/s], shape (n,).
        """
        own = step * np.einsum("kjj->kj", self.dry).max(axis=0)
        rough = self.rough
        if not rough.any():
            return np.full(len(own), DEFAULT_SIGN_WIDTH)
        scaled = step * self.dry[:, :, rough] / own[rough]
        width = np.where(rough, own * _radius(scaled[:, rough, :]).max() / STABLE, 0.0)
        return np.maximum(width, DEFAULT_SIGN_WIDTH)

    def step(self, given: float | None) -> float:
        """Choose a stable step.

        Args:
            given: Step of the user [s]; if None, a step is chosen at which friction is sharp.

        Returns:
            Step h [s].

        Raises:
            ModelError: If the given step, or any, is too large for the plant's friction.
        """
        stable = STABLE / self.viscous if self.viscous > 0 else np.inf
        if given is not None:
            if not 0 < given <= stable:
                raise ModelError(
                    f"for this friction a step must be above 0 and at most {stable:.2g} s, given {given:g} s"
                )
            return given
        if stable < SMALLEST_STEP:
            raise ModelError(
                f"friction damps a joint within {1 / self.viscous:.2g} s, too fast to simulate: it is large "
                "beside the inertia that the URDF gives this joint (is a rotor_inertia missing?)"
            )
        per_second = self.sign_width(1.0)
        asked = self.speed > 0
        sharp = np.min(SHARP_ENOUGH * self.speed[asked] / per_second[asked], initial=LONGEST_STEP)
        return float(min(max(sharp, FINEST_STEP), stable))


def _jump(plant: Dynamics, x: State, before: float, after: float) -> Array:
    """Compute f(q̇ⱼ + after) − f(q̇ⱼ + before) for each joint j [N·m or N], shape (K, n, n)."""
    columns = []
    for axis in np.eye(plant.robot.n):
        later, sooner = (plant.missing_torque(replace(x, v=x.v + s * axis)) for s in (after, before))
        columns.append(later - sooner)
    return np.stack(columns, axis=-1)


def _radius(matrices: Array) -> Array:
    """Compute the spectral radius of each matrix, shape (K,)."""
    return np.asarray(np.abs(np.linalg.eigvals(matrices)).max(axis=-1))


def _row(x: State, k: int) -> State:
    part = np.s_[k : k + 1]
    return State(x.robot, x.q[part], x.v[part], x.a[part], x.effort[part], x.time[part], x.sign_width)
