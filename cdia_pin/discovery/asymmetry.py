"""Whether friction differs between the directions: notably, surely, and in each half of the log that could show it."""

from __future__ import annotations

import numpy as np

from cdia_pin.discovery.trust import Repeat
from cdia_pin.effects import Term

CERTAIN = 3.0  # difference between the directions over its standard deviation [1], above which it is real
NOTABLE = 0.1  # RMS torque that differs between the directions over the friction's [1]; less, nobody calls asymmetric


def is_asymmetric(whole: Repeat, term: Term, beside_structure: bool) -> bool:
    """Tell whether the directions differ notably, surely, and in both halves of the log as far as they can show it.

    Args:
        whole: The decision on the whole log.
        term: A term of asymmetric friction.
        beside_structure: Whether the joint's residual has structure in any case, which asymmetry may follow by chance:
            then one half must show it.
    """
    theta = np.array(term.theta)
    mean = np.repeat([theta[:2].mean(), theta[2:].mean()], 2)
    if np.max(whole.torque(term, theta - mean)) <= NOTABLE * np.max(whole.torque(term, theta)):
        return False
    return any(_differ(whole, term, k, beside_structure) for k in (0, 2))


def _differ(whole: Repeat, term: Term, k: int, one_must: bool) -> bool:
    """Tell whether two parameters differ in the whole log, and alike in each half that could show it."""
    difference, spread = _difference(whole, term, k)
    if abs(difference) <= CERTAIN * spread:
        return False
    halves = [_difference(half, term, k) for half in whole.halves]
    telling = [(value, s) for value, s in halves if abs(difference) >= 2 * CERTAIN * s]
    if one_must and not telling:
        return False
    return all(value * np.sign(difference) > CERTAIN * s for value, s in telling)


def _difference(repeat: Repeat, term: Term, k: int) -> tuple[float, float]:
    """Return the difference of two neighbouring parameters, and its standard deviation."""
    theta, covariance = repeat.theta(term), repeat.covariance(term)
    variance = covariance[k, k] + covariance[k + 1, k + 1] - 2 * covariance[k, k + 1]
    return float(theta[k] - theta[k + 1]), float(np.sqrt(max(variance, 0.0)))
