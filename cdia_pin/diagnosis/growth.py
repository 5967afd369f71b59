"""Growth of the largest healthy residual with time: how much wider a threshold from few seconds has to be."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.momentum_observer import REST_WIDTHS

Array = NDArray[np.float64]

REFERENCE_DURATION = 120.0  # [s], of healthy motion for which the margins of `MonitorSettings` were chosen


def moving_time(velocities: Sequence[Array], sign_width: Array, dt: float) -> Array:
    """Return how long each joint moves [s], shape (n,).

    Args:
        velocities: Of each run [rad/s or m/s], shape (K, n) each.
        sign_width: Speed over which sgn q̇ is smoothed [rad/s or m/s], shape (n,).
        dt: Time between samples [s].
    """
    return np.asarray(dt * sum((np.abs(v) > REST_WIDTHS * sign_width).sum(axis=0) for v in velocities))


def growth(duration: Array, memory: Array) -> Array:
    """Return the largest residual of the reference duration over that of a shorter one [1], shape (n,).

    A residual has one independent value per correlation time. The median of the largest of N normal values lies
    where Φ is (1 + 0.5^(1/N)) / 2. It grows with N, quickly while N is small.

    Args:
        duration: How long each joint moves in the healthy runs [s], shape (n,).
        memory: Correlation time of each joint's residual [s], shape (n,).
    """
    seen, usual = (np.maximum(seconds / memory, 1.0) for seconds in (duration, REFERENCE_DURATION))
    return np.asarray(np.maximum(_largest(usual) / _largest(seen), 1.0))


def _largest(count: Array) -> Array:
    """Return the median of the largest size of N normal values [standard deviations]."""
    from scipy.special import ndtri

    return np.asarray(ndtri(0.5 * (1.0 + 0.5 ** (1.0 / count))))
