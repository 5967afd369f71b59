r"""The limit of an alarm, computed from the rate of false alarms that the user accepts.

The statistic of a course is the largest :math:`|z|` of a step at least m logs ago, asked anew after each log. In white
noise the mean number of logs to a false alarm is [Siegmund1995]

.. math::

    E_\infty(N) = \frac{\sqrt{2\pi}\, e^{b^2/2}}{b \int_{0}^{b/\sqrt m} x\, \nu^2(x)\, dx},
    \qquad \nu(x) \approx \frac{(2/x)(\Phi(x/2) - 1/2)}{(x/2)\Phi(x/2) + \varphi(x/2)}
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

FEWEST_AFTER = 3  # logs after a change [1], because two bad logs in a row are no change
LOWEST, HIGHEST = 2.0, 12.0  # limits [1] between which it is looked for
STEPS = 400  # of the integral [1]


def alarm_limit(logs: float) -> float:
    """Return the limit of :math:`|z|` at which a course without change gives an alarm once in so many logs.

    Args:
        logs: Mean number of logs to a false alarm [1].
    """
    from scipy.optimize import brentq

    wanted = math.log(max(logs, 1.0))
    if wanted <= _log_run_length(LOWEST):
        return LOWEST
    if wanted >= _log_run_length(HIGHEST):
        return HIGHEST
    return float(brentq(lambda b: _log_run_length(b) - wanted, LOWEST, HIGHEST, xtol=1e-6))


def run_length(limit: float) -> float:
    """Return the mean number of logs to a false alarm [1].

    Args:
        limit: Limit of :math:`|z|` [1].
    """
    return math.exp(_log_run_length(limit))


def _log_run_length(b: float) -> float:
    end = b / math.sqrt(FEWEST_AFTER)
    x = (np.arange(STEPS) + 0.5) * end / STEPS
    integral = float(np.sum(x * _overshoot(x) ** 2) * end / STEPS)
    return 0.5 * math.log(2 * math.pi) + b * b / 2 - math.log(b * integral)


def _overshoot(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ν(x), the mean discount of what a sum exceeds a limit by [1]."""
    from scipy.special import ndtr

    density = np.exp(-((x / 2) ** 2) / 2) / math.sqrt(2 * math.pi)
    return np.asarray((2 / x) * (ndtr(x / 2) - 0.5) / ((x / 2) * ndtr(x / 2) + density), float)
