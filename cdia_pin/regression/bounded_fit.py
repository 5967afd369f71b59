"""A fit within physical bounds: the parameters are possible for a real arm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.physical_consistency import consistent_parameters

Array = NDArray[np.float64]

# Variance of a parameter over that without the other parameters [1]; above it, it repeats them.
MOST_INFLATION = 1e5
# Rounds [1] in which parameters that violate a bound are fixed at it; a guard, because each round fixes more.
REPAIRS = 4


@dataclass(frozen=True, repr=False)
class BoundedFit:
    """A set of effects fitted together, with parameters within their bounds.

    Attributes:
        theta: Parameters of the set, one effect after another, shape (p,).
        chi2: Residual sum of squares, in variances of the noise [1].
        objective: What the fit minimised: chi2 and the distance from the prior [1].
        possible: True if the parameters are within their bounds.
        physical: True if, besides, no parameter repeats the others, and no effect reduces to a simpler one.
    """

    theta: Array
    chi2: float
    objective: float
    possible: bool
    physical: bool

    def __repr__(self) -> str:
        return f"BoundedFit({len(self.theta)} parameters, chi2 {self.chi2:.4g}, physical {self.physical})"


def bounded_fit(equations: NormalEquations, chosen: Sequence[int], *, bodies: bool = False) -> BoundedFit:
    """Fit a set of effects together, and fix parameters at the bounds that they would violate.

    Args:
        equations: Normal equations of the effects.
        chosen: Indices of the set.
        bodies: Make rigid bodies physically consistent too [Wensing2018]. This takes a hundred times longer.
    """
    theta, _ = equations.optimum(chosen)
    if chosen and not _in_bounds(equations, chosen, theta):
        theta = _bounded(equations, chosen, theta)
    if bodies and not _are_consistent(equations, chosen, theta):
        theta = consistent_parameters(
            equations.with_prior(chosen),
            equations.total[equations.columns(chosen), -1],
            [equations.effects[c] for c in chosen],
            equations.robot,
        )
    possible = _in_bounds(equations, chosen, theta)
    physical = (
        possible
        and not equations.is_redundant(chosen, MOST_INFLATION)
        and _are_distinct(equations, chosen, theta)
    )
    chi2 = equations.chi2(equations.columns(chosen), theta)
    return BoundedFit(theta, chi2, chi2 + equations.from_prior(chosen, theta), possible, physical)


def _bounds(equations: NormalEquations, chosen: Sequence[int]) -> tuple[Array, Array]:
    lower, upper = (np.concatenate(b) for b in zip(*(equations.bounds[c] for c in chosen), strict=True))
    return lower, upper


def _bounded(equations: NormalEquations, chosen: Sequence[int], theta: Array) -> Array:
    """Return parameters within their bounds; those that would violate a bound are fixed at it."""
    lower, upper = _bounds(equations, chosen)
    columns = equations.columns(chosen)
    free = np.ones(len(columns), bool)
    for _ in range(REPAIRS):
        inside = np.clip(theta, lower, upper)
        if not ((inside != theta) & free).any():
            break
        free &= inside == theta
        theta = equations.solve(columns, free, inside)
    return np.clip(theta, lower, upper)


def _in_bounds(equations: NormalEquations, chosen: Sequence[int], theta: Array) -> bool:
    if not chosen:
        return True
    lower, upper = _bounds(equations, chosen)
    return bool(np.all(theta >= lower) and np.all(theta <= upper))


def _are_distinct(equations: NormalEquations, chosen: Sequence[int], theta: Array) -> bool:
    """Return True if no effect of a set reduces to a simpler one of the vocabulary."""
    effects = [equations.effects[c] for c in chosen]
    parts = ParameterBlocks.of(effects).split(theta)
    return all(e.is_distinct(part) for e, part in zip(effects, parts, strict=True))


def _are_consistent(equations: NormalEquations, chosen: Sequence[int], theta: Array) -> bool:
    """Return True if the rigid bodies of a set are physically consistent."""
    effects = [equations.effects[c] for c in chosen]
    parts = ParameterBlocks.of(effects).split(theta)
    return all(
        e.is_physical(part, equations.robot) for e, part in zip(effects, parts, strict=True) if e.bodies
    )
