r"""Velocity observers (3.6) and isolation filters (3.11): any number that share a basis, stepped together.

.. math:: \ddot{\hat q} = M^{-1}(\tau + \hat f - V - G) - \gamma(\dot{\hat q} - \dot q), \qquad
          \dot e = -\gamma e + M^{-1}(\hat f - \rho)

(3.11) is printed without M⁻¹τ; here it has it. What is integrated is the error, exactly for a constant ρ.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.thesis.basis import Basis
from cdia_pin.diagnosis.thesis.gains import AdaptationInputs, Gains
from cdia_pin.diagnosis.thesis.sample_interval import SampleInterval
from cdia_pin.diagnosis.thesis.threshold import decay

Array = NDArray[np.float64]


@dataclass(eq=False)
class VelocityObservers:
    """F observers on one basis of P columns.

    Attributes:
        basis: Columns and their bounds.
        gains: Law of adaptation.
        gamma: γ [1/s], shape (n,).
        used: Which columns each has, (F, P), 0 or 1.
        weights: W, (F, n, P).
        error: e = q̂̇ − q̇ [rad/s or m/s], (F, n).
    """

    basis: Basis
    gains: Gains
    gamma: Array
    used: Array
    weights: Array
    error: Array

    @classmethod
    def fresh(cls, basis: Basis, gains: Gains, gamma: Array, used: Array | None = None) -> VelocityObservers:
        """Return observers that know nothing; one with all columns if none are named."""
        used = np.ones((1, len(basis.of_torque))) if used is None else used
        n = len(gamma)
        return cls(
            basis, gains, gamma, used, np.zeros((len(used), n, used.shape[1])), np.zeros((len(used), n))
        )

    def torque(self, columns: Array) -> Array:
        """Return f̂ [N·m or N] for columns φ (n, P), shape (F, n)."""
        return np.einsum("np,fnp->fn", columns, self.weights)

    def step(self, step: SampleInterval, scale: ColumnScale, known: Array | float = 0.0) -> Array:
        """Advance the errors over a step and return them; weights stay.

        Args:
            step: What happened.
            scale: Columns of the step.
            known: Torque already accounted for [N·m or N], shape (n,).
        """
        left, gain = decay(self.gamma, step.duration)
        lack = self.torque(scale.columns) + known - step.missing
        self.error = left * self.error + gain * (lack @ step.inverse_inertia.T)
        return self.error

    def adapt(self, step: SampleInterval, scale: ColumnScale, which: NDArray[np.bool_]) -> None:
        """Let the weights of some observers, (F,), follow the law over a step, within their bounds."""
        if not which.any():
            return
        at = AdaptationInputs(
            scale.columns,
            self.used,
            self.basis.of_torque,
            step.inverse_inertia,
            scale.reference,
            scale.largest,
            self.gamma,
            step.duration,
        )
        change = step.duration * self.gains.rate(self.error, at) * which[:, None, None]
        self.weights = np.clip(self.weights + change, *self.basis.bounds) * self.used[:, None, :]

    def only(self, index: int) -> VelocityObservers:
        """Return one of them, with its memory."""
        kept = slice(index, index + 1)
        return VelocityObservers(
            self.basis,
            self.gains,
            self.gamma,
            self.used[kept],
            self.weights[kept].copy(),
            self.error[kept].copy(),
        )


class ColumnScale:
    """Columns of a basis at the last step, and how large they and M⁻¹ have been: memory of the gains.

    Args:
        basis: Whose columns.
    """

    def __init__(self, basis: Basis) -> None:
        self._basis = basis
        self.columns = self.largest = self.reference = np.empty(0)

    def see(self, step: SampleInterval) -> None:
        """Take note of a step."""
        self.columns = self._basis.columns(step.joints)
        if not self.reference.size:
            self.reference = step.inverse_inertia.diagonal().copy()
            self.largest = np.zeros_like(self.columns)
        self.largest = np.maximum(self.largest, np.abs(self.columns))
