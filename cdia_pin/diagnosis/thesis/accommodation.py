"""Accommodation: the corrected torque ([Thesis] §3.6)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def accommodate(
    nominal: Array, torque: Callable[[Array], Array], smallest_gain: float, limit: Array
) -> Array:
    """Return τ = (τ₀ − f̂)/(1 + h), under which a faulty arm moves as a healthy one does under τ₀ [N·m or N], (n,).

    Args:
        nominal: τ₀ [N·m or N], shape (n,).
        torque: f̂ as a function of the torque that acts: a constant, and a part that is proportional to the torque
            for either sign [N·m or N], shape (n,).
        smallest_gain: ε [1]; a joint with |1 + h| below it gets τ₀, and so does one whose f̂ is not finite.
        limit: Largest effort [N·m or N], shape (n,).
    """
    still = torque(np.zeros_like(nominal))
    tau = nominal - still
    for _ in range(2):  # the second time with the right sign of the torque
        sign = np.sign(tau)
        gained = torque(tau) - still
        gain = 1.0 + np.divide(gained, tau, out=np.zeros_like(tau), where=tau != 0)
        usable = np.isfinite(gain) & np.isfinite(still) & (np.abs(gain) > smallest_gain)
        tau = np.where(usable, (nominal - still) / np.where(usable, gain, 1.0), nominal)
        if (np.sign(tau) == sign).all():
            break
    return np.minimum(np.maximum(tau, -limit), limit)
