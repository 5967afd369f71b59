"""The sign of a speed, smoothed through rest."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

# [1], change of the speed between two samples over the width of the sign, below which the sign of an instant is exact
# to 10⁻⁸ and its integral only adds rounding errors
SLOW = 1e-2


def smooth_sign(v: ArrayLike, width: ArrayLike, a: ArrayLike = 0.0, period: float = 0.0) -> Array:
    r"""Return tanh(v / w), or in a sampled motion what a filter of its samples needs in place of it.

    A step that falls between two samples is up to half a sample late or early if it is sampled at instants. So its
    integral is sampled, for a speed that changes evenly by c = a T, and differentiated by a central difference of
    fourth order:

    .. math:: \frac{27 (I_{1/2} - I_{-1/2}) - (I_{3/2} - I_{-3/2})}{24\, c}, \qquad
        I_k = w \ln \cosh \frac{v + k c}{w}

    Args:
        v: Speeds [rad/s or m/s], any shape.
        width: Speed w below which the sign is smoothed [rad/s or m/s], of a shape that v can take.
        a: Accelerations [rad/s² or m/s²], of a shape that v can take.
        period: Time T between two samples [s]; 0 for the sign at an instant.

    Returns:
        Within ± 1 at an instant, in a sampled motion beside a step up to a twelfth more [1], shape of v.
    """
    middle: Array = np.asarray(v, float) / np.asarray(width, float)
    at_once = np.tanh(middle)
    if not period:  # in a simulation or a control loop, sample by sample
        return at_once
    step: Array = np.asarray(a, float) * period / np.asarray(width, float)
    fast = np.abs(step) > SLOW
    if not fast.any():
        return at_once
    c = np.where(fast, step, 1.0)
    near, far = (_ln_cosh(middle + k * c) - _ln_cosh(middle - k * c) for k in (0.5, 1.5))
    return np.where(fast, (27 * near - far) / (24 * c), at_once)


def _ln_cosh(x: Array) -> Array:
    """Return ln cosh x + ln 2 without overflow."""
    return np.asarray(np.abs(x) + np.log1p(np.exp(-2 * np.abs(x))))
