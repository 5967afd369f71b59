r"""How fast weights adapt: the Lyapunov law of [Thesis] §3.4 with the sign that belongs to e = q̂̇ − q̇.

With :math:`\dot e = -\gamma e + M^{-1}\sum\mathrm{diag}(\Phi)\tilde W` and
:math:`U = \tfrac12 e^T P e + \tfrac12 \tilde W^T \Gamma^{-1} \tilde W`, the law

.. math:: \dot W = -\Gamma\,\mathrm{diag}(\Phi)\,M^{-1} P e

leaves :math:`\dot U = -e^T P \gamma e \le 0`. The printed + makes the same term positive: weights run away.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FASTEST = 0.5  # [rad] per step, of a joint and its weights
TINY = 1e-12  # keeps columns that were never excited from dividing by zero


@dataclass(frozen=True, slots=True, eq=False)
class AdaptationInputs:
    """What the law needs to know of a step.

    Attributes:
        columns: φ, (n, P).
        used: Which columns each filter has, (F, P), 0 or 1.
        of_torque: Which columns are in proportion to the torque, (P,).
        inverse_inertia: M⁻¹, (n, n).
        reference: Diagonal of M⁻¹ where the arm began, (n,).
        largest: Largest size of each column so far, (n, P).
        gamma: γ [1/s], (n,).
        duration: Length of the step [s].
    """

    columns: Array
    used: Array
    of_torque: NDArray[np.bool_]
    inverse_inertia: Array
    reference: Array
    largest: Array
    gamma: Array
    duration: float


class Gains(Protocol):
    """A choice of P and Γ."""

    def rate(self, error: Array, at: AdaptationInputs) -> Array:
        """Return Ẇ, (F, n, P), for the errors e of F filters [rad/s or m/s], (F, n)."""
        ...


@dataclass(frozen=True)
class FixedGains:
    """P = I and constant Γ, as the thesis has it; the gains are to be found for each arm.

    Attributes:
        torque: Γ of columns in proportion to the torque, one per joint.
        state: Γ of all other columns, one per joint.
    """

    torque: tuple[float, ...]
    state: tuple[float, ...]

    def rate(self, error: Array, at: AdaptationInputs) -> Array:
        """Return Ẇ = −Γ diag(Φ) M⁻¹ e, (F, n, P)."""
        gain = np.where(at.of_torque, np.array(self.torque)[:, None], np.array(self.state)[:, None])
        drive = error @ at.inverse_inertia.T
        return -(gain * at.columns) * drive[:, :, None] * at.used[:, None, :]


@dataclass(frozen=True)
class ScaledGains:
    """P and Γ in units of each joint's own inertia, and columns in units of their size: one number for any arm.

    P = diag(M⁻¹)⁻¹ where the arm began, Γ = share · γ² · P / Σ(φ/φ_max)²: alone, a joint and its weights are
    then a second-order system with natural frequency √share · γ, critically damped for a share of a quarter. Torques
    of joints that the arm couples are told apart more slowly, 130 times on the stretched SCARA and 24 times on a UR5
    in the median, which asks for more. The frequency is kept below half a radian per step, where the discrete law
    is stable.

    Dividing by the excitation makes Γ vary with time, for which U̇ ≤ 0 holds only while it varies slowly.

    Attributes:
        share: Of γ² [1].
    """

    share: float = 25.0

    def rate(self, error: Array, at: AdaptationInputs) -> Array:
        """Return Ẇ = −Γ diag(Φ) M⁻¹ P e, normalised, (F, n, P)."""
        P = 1.0 / at.reference
        speed = np.minimum(self.share * at.gamma**2, (FASTEST / at.duration) ** 2)  # [1/s²]
        drive = speed * P * ((error * P) @ at.inverse_inertia.T)  # [N·m/s], (F, n)
        sized = at.columns / np.maximum(at.largest, TINY)
        excitation = sized**2 @ at.used.T  # (n, F)
        drive = drive / np.maximum(excitation.T, 1e-3)
        return -(sized / np.maximum(at.largest, TINY)) * drive[:, :, None] * at.used[:, None, :]
