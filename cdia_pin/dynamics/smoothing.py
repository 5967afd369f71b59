r"""How sharply friction may change its sign, and how large a step may be, in an explicit integration.

A joint that dry friction stops within a step overshoots: instead of resting it chatters by α h / m, with
friction α, step h and inertia m. With sgn q̇ smoothed to tanh(q̇ / w) friction is at rest a damper α / w, and
steps are stable as long as

.. math:: h\, \rho(M^{-1} A W^{-1}) < 1, \qquad A_{ij} = -\tfrac12 [f_i(\dot q_j = 0^+) - f_i(\dot q_j = 0^-)]

with ρ the spectral radius and W the widths w. Widths here are the narrowest that keep it at 0.5 along the
motion. The price: below its w a joint creeps where real friction would hold it.
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

STABLE = 0.5  # [1], h ρ that is aimed at; the integrator's own limit is 1
POSTURES = 12  # along the motion, at which friction is looked at
NUDGE = 1e-5  # [rad/s or m/s], to either side of a speed
SHARP = 1e-9  # [rad/s or m/s], width at which sgn is a step beside the nudge
LONGEST_STEP, FINEST_STEP = 1e-3, 2e-4  # [s], between which a step is chosen
SMALLEST_STEP = 1e-5  # [s], what needs a smaller one is refused
SHARP_ENOUGH = 0.005  # [1], width over largest speed that needs no smaller step


@dataclass(frozen=True)
class Stiffness:
    """How fast friction acts on an arm along a motion.

    Attributes:
        dry: M⁻¹A, by how much dry friction slows each joint [rad/s² or m/s²], shape (K, n, n).
        viscous: Largest rate ρ(M⁻¹ ∂f/∂q̇) at which friction damps a joint in motion [1/s].
        speed: Largest speed asked of each joint [rad/s or m/s], shape (n,).
    """

    dry: Array
    viscous: float
    speed: Array

    @classmethod
    def of(cls, plant: Dynamics, trajectory: Trajectory) -> Stiffness:
        """Look at a plant's friction along a motion, as if all its terms were present all the time.

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
        """Which joints have dry friction, shape (n,)."""
        return np.einsum("kjj->kj", self.dry).max(axis=0) > 0

    def sign_width(self, step: float) -> Array:
        """Return the narrowest stable smoothing of each joint's sgn [rad/s or m/s], shape (n,)."""
        own = step * np.einsum("kjj->kj", self.dry).max(axis=0)
        rough = self.rough
        if not rough.any():
            return np.full(len(own), DEFAULT_SIGN_WIDTH)
        scaled = step * self.dry[:, :, rough] / own[rough]
        width = np.where(rough, own * _radius(scaled[:, rough, :]).max() / STABLE, 0.0)
        return np.maximum(width, DEFAULT_SIGN_WIDTH)

    def step(self, given: float | None) -> float:
        """Return a stable step [s]: the one given, or else one at which friction is sharp.

        Raises:
            ModelError: If the given step, or any, is too large for the plant's friction.
        """
        stable = STABLE / self.viscous if self.viscous > 0 else np.inf
        if given is not None:
            if not 0 < given <= stable:
                raise ModelError(
                    f"for this friction a step lies within 0 and {stable:.2g} s, given {given:g} s"
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
    """f(q̇ⱼ + after) − f(q̇ⱼ + before) for each joint j, shape (K, n, n)."""
    columns = []
    for axis in np.eye(plant.robot.n):
        later, sooner = (plant.missing_torque(replace(x, v=x.v + s * axis)) for s in (after, before))
        columns.append(later - sooner)
    return np.stack(columns, axis=-1)


def _radius(matrices: Array) -> Array:
    """Spectral radius of each matrix, shape (K,)."""
    return np.abs(np.linalg.eigvals(matrices)).max(axis=-1)


def _row(x: State, k: int) -> State:
    part = np.s_[k : k + 1]
    return State(x.robot, x.q[part], x.v[part], x.a[part], x.effort[part], x.time[part], x.sign_width)
