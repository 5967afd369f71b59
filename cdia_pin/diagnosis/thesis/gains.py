r"""The adaptation law of the weights: the Lyapunov law of [Thesis] §3.4, with the sign for e = q̂̇ − q̇.

With :math:`\dot e = -\gamma e + M^{-1}\sum\mathrm{diag}(\Phi)\tilde W` and
:math:`U = \tfrac12 e^T P e + \tfrac12 \tilde W^T \Gamma^{-1} \tilde W`, the law

.. math:: \dot W = -\Gamma\,\mathrm{diag}(\Phi)\,M^{-1} P e

leaves :math:`\dot U = -e^T P \gamma e \le 0`. With the printed + the same term is positive, and weights run away.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FASTEST = (
    0.5  # [rad] per step, natural frequency of a joint and its weights, at which the discrete law is stable
)
LEAST_EXCITATION = 1e-3  # [1], sum of squared columns that the gains divide by: keeps them finite at rest
TINY = 1e-12  # keeps columns that were never excited from dividing by zero


@dataclass(frozen=True, slots=True, eq=False)
class AdaptationInputs:
    """Inputs of the adaptation law over one interval.

    Attributes:
        columns: φ, shape (n, P).
        used: Columns that each filter has, 0 or 1, shape (F, P).
        of_torque: Which columns are proportional to the torque, shape (P,).
        inverse_inertia: M⁻¹ [1/(kg·m²)], shape (n, n).
        reference: Diagonal of M⁻¹ at the first interval [1/(kg·m²)], shape (n,).
        largest: Largest size of each column so far, shape (n, P).
        gamma: γ [1/s], shape (n,).
        duration: Length of the interval [s].
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
        """Return Ẇ of F filters, shape (F, n, P).

        Args:
            error: Velocity errors e [rad/s or m/s], shape (F, n).
            at: Inputs of the law.
        """
        ...


@dataclass(frozen=True)
class FixedGains:
    """P = I and constant Γ, as in the thesis; each arm needs gains of its own.

    Attributes:
        torque: Γ of columns that are proportional to the torque, one per joint.
        state: Γ of all other columns, one per joint.
    """

    torque: tuple[float, ...]
    state: tuple[float, ...]

    def rate(self, error: Array, at: AdaptationInputs) -> Array:
        """Return Ẇ = −Γ diag(Φ) M⁻¹ e, shape (F, n, P); see `Gains.rate`.

        Args:
            error: Velocity errors e [rad/s or m/s], shape (F, n).
            at: Inputs of the law.
        """
        gain = np.where(at.of_torque, np.array(self.torque)[:, None], np.array(self.state)[:, None])
        drive = error @ at.inverse_inertia.T
        return -(gain * at.columns) * drive[:, :, None] * at.used[:, None, :]


@dataclass(frozen=True)
class ScaledGains:
    """P and Γ in units of each joint's inertia, and columns in units of their size: one number fits any arm.

    P = diag(M⁻¹)⁻¹ at the first interval, Γ = share · γ² · P / Σ(φ/φ_max)²: alone, a joint and its weights are
    then a second-order system with natural frequency √share · γ, critically damped for a share of a quarter. Torques
    of joints that the arm couples separate more slowly, 130 times on the stretched SCARA and 24 times on a UR5 in the
    median, so a larger share is needed. The frequency is kept below half a radian per step, where the discrete law
    is stable.

    Division by the excitation makes Γ vary with time; U̇ ≤ 0 holds only while it varies slowly.

    Attributes:
        share: Square of the natural frequency over γ² [1].
    """

    share: float = 25.0

    def rate(self, error: Array, at: AdaptationInputs) -> Array:
        """Return Ẇ = −Γ diag(Φ) M⁻¹ P e, normalised, shape (F, n, P); see `Gains.rate`.

        Args:
            error: Velocity errors e [rad/s or m/s], shape (F, n).
            at: Inputs of the law.
        """
        P = 1.0 / at.reference
        speed = np.minimum(self.share * at.gamma**2, (FASTEST / at.duration) ** 2)  # [1/s²]
        drive = speed * P * ((error * P) @ at.inverse_inertia.T)  # [N·m/s], (F, n)
        sized = at.columns / np.maximum(at.largest, TINY)
        excitation = sized**2 @ at.used.T  # (n, F)
        drive = drive / np.maximum(excitation.T, LEAST_EXCITATION)
        return -(sized / np.maximum(at.largest, TINY)) * drive[:, :, None] * at.used[:, None, :]
