"""Gauss-Newton: all terms of a model fitted together, to their common optimum."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Signal
from cdia_pin.errors import EffectError
from cdia_pin.regression.bounded_fit import BoundedFit, bounded_fit
from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.regression import Regression
from cdia_pin.regression.shape_slopes import slopes

Array = NDArray[np.float64]

# What a fit ends in whose parameters grow without bound, as those of effects that nearly cancel each other may.
DIVERGED = (EffectError, np.linalg.LinAlgError)
MOST_ITERATIONS = 20  # iterations [1]; a guard against slow convergence
# Standard deviations [1]. A step of d of them lowers the sum of squares by d² variances of the residual; when a step
# lowers it by less, the fit has converged. Parameters that the log hardly distinguishes may still move.
CONVERGED = 0.1
# Sum of squares that the first step from impossible parameters leaves, over what the linearisation promises [1]; above,
# it diverges.
MOST_LEFT = 30.0
# Times [1] that a step is halved; if the shortest one still leaves more, the fit has ended. Four give the same effects
# on a Panda and an LWR4+, but do not bring back a step of 30 N·m.
MOST_HALVED = 8


class Before(NamedTuple):
    """What the step to a model began with.

    Attributes:
        theta: Parameters of the model's terms before the step, one term after another, shape (P,).
        left: What a fit minimises there [1].
    """

    theta: Array
    left: float


def is_exact(effect: Effect) -> bool:
    """Return True if normal equations describe an effect exactly, at any size of its parameters.

    Args:
        effect: The effect.
    """
    return effect.traits.linear and Signal.TORQUE not in effect.traits.depends_on


def _is_linear(model: Dynamics) -> bool:
    """Return True if normal equations describe a model exactly, at any size of its parameters."""
    return all(is_exact(t.effect) and Signal.TORQUE not in t.profile.depends_on for t in model.terms)


def fitted_together(
    regression: Regression,
    model: Dynamics,
    iterations: int = MOST_ITERATIONS,
    before: Before | None = None,
) -> Dynamics:
    """Fit all terms of a model together by the Gauss-Newton method.

    Args:
        regression: The conditioned logs and their noise.
        model: The model; the iteration starts at the parameters of its terms.
        iterations: Largest number of iterations; those that only halve a step do not count.
        before: What the step to the model began with, if it is one of the iteration; it may be too long too.

    Returns:
        The model at the optimum.
    """
    return _iterated(regression, model, iterations, before)[0]


def refit(
    regression: Regression, model: Dynamics, iterations: int = MOST_ITERATIONS
) -> tuple[Dynamics, NormalEquations]:
    """Fit all terms of a model together as `fitted_together` does, with the normal equations at the optimum.

    Args:
        regression: The conditioned logs and their noise.
        model: The model; the iteration starts at the parameters of its terms.
        iterations: Largest number of iterations.

    Returns:
        The model at the optimum, and the normal equations there, of its terms and then of the slopes of their shapes.
    """
    model, equations = _iterated(regression, model, iterations)
    effects, of_shapes = [t.effect for t in model.terms], list(slopes(model))
    if of_shapes or not _is_linear(model):
        equations = regression.normal_equations(model, [*effects, *of_shapes])
    return model, equations


def _iterated(
    regression: Regression, model: Dynamics, iterations: int, before: Before | None = None
) -> tuple[Dynamics, NormalEquations]:
    """Return the model at the optimum, and the normal equations of the last iteration.

    A step that leaves more than there was before it was too long for the linearisation, and is halved. One from
    impossible parameters is compared with what it promised: they may fit better than anything that is possible.
    """
    effects = [t.effect for t in model.terms]
    every = range(len(effects))
    # parameters before the last step, and what may be left after it [1]
    kept, limit = before or Before(np.zeros(0), np.inf)
    most = 1 if _is_linear(model) else iterations
    equations = regression.normal_equations(model, effects)
    for step in range(most):
        shorter = _shortened(regression, model, kept, limit, equations)
        if shorter is None:
            return with_parameters(model, kept), equations
        if step or shorter is not model:
            model, equations = shorter, regression.normal_equations(shorter, effects)
        theta = model.theta
        left = equations.objective(every, theta)
        fit = bounded_fit(equations, every, bodies=True)
        began_possible = limit < np.inf or is_possible(model)  # a limit is that of a step before
        limit = left if began_possible else max(left, MOST_LEFT * fit.objective)
        model, kept = with_parameters(model, fit.theta), theta
        # bodies are made possible to a tolerance: a step from possible ones may even promise a little more
        gained = left - fit.objective
        if has_converged(gained if step else abs(gained), fit, equations):
            break
    return model, equations


def _shortened(
    regression: Regression, model: Dynamics, kept: Array, limit: float, near: NormalEquations
) -> Dynamics | None:
    """Return the model at the end of a step, halved until it leaves no more than there was; None if that is too short.

    Args:
        regression: The conditioned logs and their noise.
        model: The model at the end of the whole step.
        kept: Parameters at its beginning, shape (P,).
        limit: What may be left [1].
        near: Normal equations near the model, for their prior.
    """
    if limit == np.inf:
        return model
    for _ in range(MOST_HALVED + 1):
        if regression.chi2(model) + near.from_prior(range(len(model.terms)), model.theta) <= limit:
            return model
        model = with_parameters(model, (model.theta + kept) / 2)
    return None


def is_possible(model: Dynamics) -> bool:
    """Return True if the parameters of all terms of a model can belong to a real arm.

    Args:
        model: The model.
    """
    return all(t.effect.is_physical(np.array(t.theta), model.robot) for t in model.terms)


def has_converged(gained: float, fit: BoundedFit, equations: NormalEquations) -> bool:
    """Tell whether a step lowers what a fit minimises by next to nothing.

    Args:
        gained: By how much, in variances of the noise [1].
        fit: The fit that the step leads to.
        equations: Normal equations of the fit.
    """
    variance = max(1.0, fit.chi2 / max(equations.samples, 1))  # of the residual, over that of the noise [1]
    return gained < CONVERGED**2 * variance


def with_parameters(model: Dynamics, theta: Array) -> Dynamics:
    """Return a model with the parameters of all its terms set.

    Args:
        model: The model.
        theta: Parameters, one term after another, shape (P,).
    """
    parts = ParameterBlocks.of(t.effect for t in model.terms).split(theta)
    terms = (t.with_theta(part) for t, part in zip(model.terms, parts, strict=True))
    return Dynamics(model.robot, tuple(terms))
