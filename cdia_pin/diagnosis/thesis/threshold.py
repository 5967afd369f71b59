r"""The thresholds of the residual of a healthy arm: both of [Thesis] §3.3, corrected.

From :math:`\dot e = -\gamma e + M^{-1}\eta` with :math:`|\eta_j| \le \eta_{0j}` follows, joint by joint,

.. math:: |e(t)| \le d(t), \qquad \dot d = -\gamma d + |M^{-1}|\,\eta_0, \qquad d(0) = 0

with the absolute value of each element of M⁻¹. The thesis prints |M⁻¹ η₀|, which is not a bound: entries of M⁻¹ of
opposite signs cancel there, but need not cancel in M⁻¹ η. Both classes advance as the residual does, so that the bound
holds for the discrete residual too.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.stateful import Stateful

Array = NDArray[np.float64]


def decay(gamma: Array, duration: float) -> tuple[Array, Array]:
    """Return E = exp(−γΔ) [1] and (1 − E)/γ [s], shape (n,).

    A step of ẋ = −γx + u with constant u is x⁺ = E x + (1 − E)/γ · u, exactly.

    Args:
        gamma: γ [1/s], shape (n,).
        duration: Δ [s].
    """
    left = np.exp(-gamma * duration)
    return left, -np.expm1(-gamma * duration) / gamma


class ThresholdForm(StrEnum):
    """Forms of the detection threshold."""

    DYNAMIC = "dynamic"
    TIME_VARYING = "time-varying"


class Threshold(Protocol):
    """A bound of the residual [rad/s or m/s], shape (n,), that starts at zero."""

    def step(self, inverse_inertia: Array, duration: float) -> Array:
        """Return the bound after a step [rad/s or m/s], shape (n,).

        Args:
            inverse_inertia: M⁻¹ [1/(kg·m²)], shape (n, n).
            duration: Length of the step [s].
        """
        ...


class DynamicThreshold(Stateful):
    """The threshold d⁺ = E d + (1 − E) γ⁻¹ |M⁻¹| η₀, which follows the arm's inertia.

    Args:
        gamma: γ [1/s], shape (n,).
        unmodelled: η₀ [N·m or N], shape (n,).
    """

    STATE = ("value",)

    def __init__(self, gamma: Array, unmodelled: Array) -> None:
        self._gamma, self._unmodelled = gamma, unmodelled
        self.value = np.zeros_like(gamma)

    def step(self, inverse_inertia: Array, duration: float) -> Array:
        """Return the bound after a step; see `Threshold.step`."""
        left, gain = decay(self._gamma, duration)
        self.value = left * self.value + gain * (np.abs(inverse_inertia) @ self._unmodelled)
        return self.value


class TimeVaryingThreshold(Stateful):
    """The threshold (I − exp(−γt)) γ⁻¹ sup(|M⁻¹| η₀), with the supremum over the past; never below the dynamic one.

    Args:
        gamma: γ [1/s], shape (n,).
        unmodelled: η₀ [N·m or N], shape (n,).
    """

    STATE = ("value", "_elapsed", "_largest")

    def __init__(self, gamma: Array, unmodelled: Array) -> None:
        self._gamma, self._unmodelled = gamma, unmodelled
        self._elapsed = 0.0
        self._largest = np.zeros_like(gamma)
        self.value = np.zeros_like(gamma)

    def step(self, inverse_inertia: Array, duration: float) -> Array:
        """Return the bound after a step; see `Threshold.step`."""
        self._elapsed += duration
        self._largest = np.maximum(self._largest, np.abs(inverse_inertia) @ self._unmodelled)
        self.value = decay(self._gamma, self._elapsed)[1] * self._largest
        return self.value


THRESHOLDS: dict[str, type[DynamicThreshold] | type[TimeVaryingThreshold]] = {
    ThresholdForm.DYNAMIC: DynamicThreshold,
    ThresholdForm.TIME_VARYING: TimeVaryingThreshold,
}
