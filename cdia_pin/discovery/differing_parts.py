"""Whether what a refinement tells apart differs: friction between the directions, a drift between start and end.

It differs if it does so notably, surely, and in each half of the log that could show it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.discovery.decision import Repeat
from cdia_pin.effects import AsymmetricFriction, Effect, Term
from cdia_pin.effects.drift import Drift

CERTAIN = 3.0  # difference between the parts over its standard deviation [1], above which it is real
# RMS torque of half the difference over that of the effect [1], up to which nobody names it: directions of a real gear
# that differ by less than a fifth, friction that changes by less than a tenth from start to end.
NOTABLE: dict[type[Effect], float] = {AsymmetricFriction: 0.1, Drift: 0.05}


def tells_apart(effect: Effect) -> bool:
    """Tell whether an effect has parts that are equal in its plain form: both directions, or start and end.

    Args:
        effect: The effect.
    """
    return type(effect) in NOTABLE


def differs(whole: Repeat, term: Term, beside_structure: bool) -> bool:
    """Tell whether the parts differ notably, surely, and in both halves of the log as far as they can show it.

    Args:
        whole: The decision on the whole log.
        term: A term of an effect that tells parts apart.
        beside_structure: Whether the joint's residual has structure in any case, which the difference may follow by
            chance: then one half must show it.
    """
    theta, pairs = np.array(term.theta), _pairs(term.effect)
    half = np.zeros_like(theta)
    half[pairs] = (theta[pairs[:, 0]] - theta[pairs[:, 1]])[:, None] / 2
    if np.max(whole.torque(term, half)) <= NOTABLE[type(term.effect)] * np.max(whole.torque(term, theta)):
        return False
    return any(_is_certain(whole, term, pair, beside_structure) for pair in pairs)


def _pairs(effect: Effect) -> NDArray[np.intp]:
    """Return the indices of the parameters that are equal in the plain form, shape (number of pairs, 2)."""
    index = np.arange(effect.size)
    return index.reshape(2, -1).T if isinstance(effect, Drift) else index.reshape(-1, 2)


def _is_certain(whole: Repeat, term: Term, pair: NDArray[np.intp], one_must: bool) -> bool:
    """Tell whether two parameters differ in the whole log, and alike in each half that could show it."""
    difference, spread = _difference(whole, term, pair)
    if abs(difference) <= CERTAIN * spread:
        return False
    halves = [_difference(half, term, pair) for half in whole.halves]
    telling = [(value, s) for value, s in halves if abs(difference) >= 2 * CERTAIN * s]
    if one_must and not telling:
        return False
    return all(value * np.sign(difference) > CERTAIN * s for value, s in telling)


def _difference(repeat: Repeat, term: Term, pair: NDArray[np.intp]) -> tuple[float, float]:
    """Return the difference of two parameters, and its standard deviation."""
    first, second = repeat.theta(term)[pair]
    (a, b), (_, c) = repeat.covariance(term)[np.ix_(pair, pair)]
    return float(first - second), float(np.sqrt(max(a - 2 * b + c, 0.0)))
