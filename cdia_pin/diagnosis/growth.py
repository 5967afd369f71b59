"""Growth of the largest healthy residual with time: how much wider a threshold from few seconds has to be."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REFERENCE_DURATION = 120.0  # [s], of healthy motion for which the margins of `MonitorSettings` were chosen


def growth(duration: float, memory: Array) -> Array:
    """Return the largest residual of the reference duration over that of a shorter one [1], shape (n,).

    A residual has one independent value per correlation time. The median of the largest of N normal values lies
    where Φ is (1 + 0.5^(1/N)) / 2. It grows with N, quickly while N is small.

    Args:
        duration: Length of the healthy residual [s].
        memory: Correlation time of each joint's residual [s], shape (n,).
    """
    seen, usual = (np.maximum(seconds / memory, 1.0) for seconds in (duration, REFERENCE_DURATION))
    return np.asarray(np.maximum(_largest(usual) / _largest(seen), 1.0))


def _largest(count: Array) -> Array:
    """Return the median of the largest size of N normal values [standard deviations]."""
    from scipy.special import ndtri

    return np.asarray(ndtri(0.5 * (1.0 + 0.5 ** (1.0 / count))))
