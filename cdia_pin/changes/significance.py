"""How certain several parameters must be together, so that chance shows them as rarely as one parameter.

Chance rarely makes several parameters large together: of ten, their root mean square is seldom far from 1. It may be
large where their covariance comes from few blocks of time, or where the best of many shapes is taken. Hotelling's T²
counts all three [Hotelling1931].
"""

from __future__ import annotations

from functools import cache
from math import sqrt


@cache
def certainty_of_several(one: float, parameters: int, shapes: int, blocks: int) -> float:
    """Return the certainty of several parameters that is as rare by chance as one of a single parameter [1].

    Args:
        one: Estimate of a single parameter over its standard deviation [1].
        parameters: Number of parameters k, whose certainty is a root mean square [1].
        shapes: Number of shapes in which the effect is tried, of which the best counts [1].
        blocks: Number of blocks of time B that their covariance is from [1].

    Returns:
        The root of T²/k that chance exceeds as often, at most that of one parameter whatever its shapes, and that where
        there are no more blocks than parameters.
    """
    from scipy.special import fdtri, stdtr

    free = blocks - parameters
    if free < 1:
        return one
    rarity = 2.0 * stdtr(blocks - 1, -one) / shapes
    # F that chance exceeds so rarely is 1 / F' of exchanged degrees of freedom, which it falls short of so rarely
    t_squared_per_parameter = (blocks - 1) / free / fdtri(free, parameters, rarity)
    return min(sqrt(t_squared_per_parameter), one)
