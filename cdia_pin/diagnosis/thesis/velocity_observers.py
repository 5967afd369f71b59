r"""Velocity observers (3.6) and isolation filters (3.11): any number on one basis, advanced together.

.. math:: \ddot{\hat q} = M^{-1}(\tau + \hat f - V - G) - \gamma(\dot{\hat q} - \dot q), \qquad
          \dot e = -\gamma e + M^{-1}(\hat f - \rho)

[Thesis] prints (3.11) without M⁻¹τ; here it is included. The error is integrated, exactly for a constant ρ.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.thesis.basis import Basis
from cdia_pin.diagnosis.thesis.gains import AdaptationInputs, Gains
from cdia_pin.diagnosis.thesis.sample_interval import SampleInterval
from cdia_pin.diagnosis.thesis.threshold import decay

Array = NDArray[np.float64]


@dataclass(eq=False)
class VelocityObservers(Stateful):
    """F observers on one basis with P columns.

    Attributes:
        basis: Columns and their bounds.
        gains: Adaptation law.
        gamma: γ [1/s], shape (n,).
        used: Columns that each observer has, 0 or 1, shape (F, P).
        weights: W, shape (F, n, P).
        error: e = q̂̇ − q̇ [rad/s or m/s], shape (F, n).
    """

    STATE = ("used", "weights", "error")

    basis: Basis
    gains: Gains
    gamma: Array
    used: Array
    weights: Array
    error: Array

    @classmethod
    def fresh(cls, basis: Basis, gains: Gains, gamma: Array, used: Array | None = None) -> VelocityObservers:
        """Return observers with zero weights and errors.

        Args:
            basis: Columns and their bounds.
            gains: Adaptation law.
            gamma: γ [1/s], shape (n,).
            used: Columns that each observer has, 0 or 1, shape (F, P); one observer with all columns if omitted.
        """
        used = np.ones((1, len(basis.of_torque))) if used is None else used
        n = len(gamma)
        return cls(
            basis, gains, gamma, used, np.zeros((len(used), n, used.shape[1])), np.zeros((len(used), n))
        )

    def torque(self, columns: Array) -> Array:
        """Return f̂ [N·m or N], shape (F, n).

        Args:
            columns: φ, shape (n, P).
        """
        return np.asarray(np.vecdot(columns, self.weights), dtype=np.float64)

    def step(self, step: SampleInterval, scale: ColumnScale, known: Array | float = 0.0) -> Array:
        """Advance the errors over an interval, and return them [rad/s or m/s], shape (F, n); weights stay.

        Args:
            step: The interval.
            scale: Columns of the interval.
            known: Torque that is accounted for already [N·m or N], shape (n,).
        """
        left, gain = decay(self.gamma, step.duration)
        lack = self.torque(scale.columns) + known - step.missing
        self.error = left * self.error + gain * (lack @ step.inverse_inertia.T)
        return self.error

    def adapt(self, step: SampleInterval, scale: ColumnScale, which: NDArray[np.bool_]) -> None:
        """Advance the weights of some observers over an interval, within their bounds.

        Args:
            step: The interval.
            scale: Columns of the interval.
            which: Observers that adapt, shape (F,).
        """
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
        """Return a copy of one observer.

        Args:
            index: Its index.
        """
        kept = slice(index, index + 1)
        return VelocityObservers(
            self.basis,
            self.gains,
            self.gamma,
            self.used[kept],
            self.weights[kept].copy(),
            self.error[kept].copy(),
        )


class ColumnScale(Stateful):
    """Columns of a basis over the last interval, and the scales by which gains are normalised.

    Args:
        basis: The basis.

    Attributes:
        columns: φ over the last interval, shape (n, P).
        largest: Largest size of each column so far, shape (n, P).
        reference: Diagonal of M⁻¹ at the first interval [1/(kg·m²)], shape (n,).
    """

    STATE = ("columns", "largest", "reference")

    def __init__(self, basis: Basis) -> None:
        self._basis = basis
        self.columns = self.largest = self.reference = np.empty(0)

    def see(self, step: SampleInterval) -> None:
        """Evaluate the columns over an interval.

        Args:
            step: The interval.
        """
        self.columns = self._basis.columns(step.joints)
        if not self.reference.size:
            self.reference = step.inverse_inertia.diagonal().copy()
            self.largest = np.zeros_like(self.columns)
        self.largest = np.maximum(self.largest, np.abs(self.columns))
