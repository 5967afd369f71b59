r"""The dynamics of the thesis' SCARA arm in closed form, correct and as the thesis prints them.

.. math:: M(\theta)\ddot\theta + V(\theta, \dot\theta) + G = \tau, \qquad
          \theta = (\theta_1, \theta_2, \theta_3, x_4)

with α = l₁²(m₁ + m₂ + m₃), β = l₂²(m₂ + m₃), γ = l₁l₂(m₂ + m₃), δ = I_z3 = ½ m₃ l₃² [Thesis]_ §4.1, §6.1.

``mass_matrix``, ``velocity_torques`` and ``gravity_torques`` are the dynamics of rigid bodies and agree
with ``robots/scara.urdf``. The ``printed_`` forms follow the text of the thesis to the letter, for study only:

- the printed M leaves δ out of M₁₁, M₁₂ and M₂₂ (its assumption 5); no rigid bodies have this matrix;
- the printed V has (θ̇₂ − 2θ̇₁) for (θ̇₂ + 2θ̇₁); it does not conserve energy.

Each function takes one sample, shape (4,), or a trajectory, shape (N, 4), and returns the same kind.
Positions [rad, rad, rad, m], torques [N·m, N·m, N·m, N].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.errors import RobotError

Array = NDArray[np.float64]

N_JOINTS = 4


@dataclass(frozen=True)
class ScaraParameters:
    """Sizes of the arm, table 1 of the thesis [Thesis]_.

    Attributes:
        m1: Mass of link 1, a point at its distal end [kg].
        m2: Mass of link 2, a point at its distal end [kg].
        m3: Mass of the quill [kg].
        l1: Length of link 1 [m].
        l2: Length of link 2 [m].
        l3: Radius of the quill [m].
        g: Gravity [m/s²].
    """

    m1: float = 50.0
    m2: float = 40.0
    m3: float = 30.0
    l1: float = 0.425
    l2: float = 0.375
    l3: float = 0.020
    g: float = 9.8

    @property
    def alpha(self) -> float:
        """Inertia of all masses at the end of link 1, l₁²(m₁ + m₂ + m₃) [kg·m²]."""
        return self.l1**2 * (self.m1 + self.m2 + self.m3)

    @property
    def beta(self) -> float:
        """Inertia of the masses at the end of link 2, l₂²(m₂ + m₃) [kg·m²]."""
        return self.l2**2 * (self.m2 + self.m3)

    @property
    def gamma(self) -> float:
        """Coupling of links 1 and 2, l₁l₂(m₂ + m₃) [kg·m²]."""
        return self.l1 * self.l2 * (self.m2 + self.m3)

    @property
    def delta(self) -> float:
        """Inertia of the quill about its axis, I_z3 = ½ m₃ l₃² [kg·m²]."""
        return 0.5 * self.m3 * self.l3**2


TABLE_1 = ScaraParameters()


def mass_matrix(q: ArrayLike, parameters: ScaraParameters = TABLE_1) -> Array:
    """Compute M(θ) of the rigid bodies, with I_z3 wherever the quill turns.

    Args:
        q: Positions [rad, rad, rad, m], shape (4,) or (N, 4).
        parameters: Sizes of the arm.

    Returns:
        M [kg·m² or kg], shape (4, 4) or (N, 4, 4).
    """
    M = printed_mass_matrix(q, parameters)
    M[..., :2, :2] += parameters.delta
    return M


def velocity_torques(q: ArrayLike, v: ArrayLike, parameters: ScaraParameters = TABLE_1) -> Array:
    """Compute the Coriolis and centrifugal torques V(θ, θ̇) of the rigid bodies.

    Args:
        q: Positions [rad, rad, rad, m], shape (4,) or (N, 4).
        v: Velocities [rad/s, rad/s, rad/s, m/s], shape of q.
        parameters: Sizes of the arm.

    Returns:
        V [N·m, N·m, N·m, N], shape of q.
    """
    return _velocity_torques(q, v, parameters, sign=+1.0)


def gravity_torques(q: ArrayLike, parameters: ScaraParameters = TABLE_1) -> Array:
    """Compute the gravity torques G = (0, 0, 0, +m₃ g), with x₄ upwards.

    Args:
        q: Positions [rad, rad, rad, m], shape (4,) or (N, 4).
        parameters: Sizes of the arm.

    Returns:
        G [N·m, N·m, N·m, N], shape of q.
    """
    G = np.zeros_like(_four(q))
    G[..., 3] = parameters.m3 * parameters.g
    return G


def nonlinear_effects(q: ArrayLike, v: ArrayLike, parameters: ScaraParameters = TABLE_1) -> Array:
    """Compute nle = V + G.

    Args:
        q: Positions [rad, rad, rad, m], shape (4,) or (N, 4).
        v: Velocities [rad/s, rad/s, rad/s, m/s], shape of q.
        parameters: Sizes of the arm.

    Returns:
        nle [N·m, N·m, N·m, N], shape of q.
    """
    nle = velocity_torques(q, v, parameters)
    nle[..., 3] += parameters.m3 * parameters.g
    return nle


def printed_mass_matrix(q: ArrayLike, parameters: ScaraParameters = TABLE_1) -> Array:
    """Compute M(θ) as the thesis prints it, without I_z3 in M₁₁, M₁₂, M₂₂; arguments as ``mass_matrix``."""
    q = _four(q)
    p = parameters
    c2 = np.cos(q[..., 1])
    M = np.zeros((*q.shape, N_JOINTS))
    M[..., 0, 0] = p.alpha + p.beta + 2.0 * p.gamma * c2
    M[..., 0, 1] = M[..., 1, 0] = p.beta + p.gamma * c2
    M[..., 1, 1] = p.beta
    M[..., 2, :3] = M[..., :3, 2] = p.delta
    M[..., 3, 3] = p.m3
    return M


def printed_velocity_torques(q: ArrayLike, v: ArrayLike, parameters: ScaraParameters = TABLE_1) -> Array:
    """Compute V(θ, θ̇) as (4.1) of the thesis prints it; arguments as ``velocity_torques``."""
    return _velocity_torques(q, v, parameters, sign=-1.0)


def _velocity_torques(q: ArrayLike, v: ArrayLike, p: ScaraParameters, sign: float) -> Array:
    q, v = _four(q), _four(v)
    g2, v1, v2 = p.gamma * np.sin(q[..., 1]), v[..., 0], v[..., 1]
    V = np.zeros(v.shape)
    V[..., 0] = -g2 * v2 * (v2 + sign * 2.0 * v1)
    V[..., 1] = g2 * v1**2
    return V


def _four(signal: ArrayLike) -> Array:
    x = np.asarray(signal, dtype=np.float64)
    if x.ndim not in {1, 2} or x.shape[-1] != N_JOINTS:
        raise RobotError(
            f"the SCARA arm has {N_JOINTS} joints: expected shape (4,) or (N, 4), given {x.shape}"
        )
    return x
