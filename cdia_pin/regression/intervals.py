"""Confidence intervals of parameters. They allow for blocks of time that scatter more than the noise does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.scaled_gram import ScaledGram

Array = NDArray[np.float64]

NORMAL_95 = 1.96  # half width of a 95 % interval of a normal distribution over its standard deviation [1]

# Variance between blocks over that within [1], because ten blocks of white noise exceed it in one case of five.
SCATTER = 1.36
RANK_CUTOFF = 1e-12  # eigenvalues of the scaled normal equations, over the largest [1], that count as zero


def with_intervals(model: Dynamics, equations: NormalEquations) -> Dynamics:
    """Return a model whose terms carry 95 % intervals.

    The intervals are those of the whitened fit. If the scores of contiguous blocks scatter more than the noise allows,
    this scatter counts instead, with its few degrees of freedom [Liang1986]. A shape that was fitted counts like a
    parameter, through its slope. Without it, a ripple of unknown frequency has intervals that are four times too
    narrow.

    Physical limits move parameters away from what the torques say. Where the torques say little of a parameter, its
    value is then that of the limits: a pendulum that shows an inertia which is too small may get a payload of 50 kg.
    So an interval is wider by as much as its parameter was moved.

    Args:
        model: A model at its optimum.
        equations: Normal equations there: of its terms, then of what else was fitted, such as shapes.
    """
    from scipy.special import ndtri, stdtrit

    if not model.terms:
        return model
    theta = model.theta
    gram = equations.total[:-1, :-1] + np.diag(equations.prior)
    inverse = ScaledGram.of(gram).pseudo_inverse(RANK_CUTOFF)
    scores = equations.blocks[:, :-1, -1] - equations.blocks[:, :-1, : len(theta)] @ theta
    degrees = len(scores) - 1
    between = np.diag(inverse @ (scores.T @ scores) @ inverse) * len(scores) / degrees
    within = np.diag(inverse)
    half = np.where(
        between > SCATTER * within,
        float(stdtrit(degrees, 0.975)) * np.sqrt(np.maximum(between, 0.0)),
        float(ndtri(0.975)) * np.sqrt(np.maximum(within, 0.0)),
    )
    moved = np.abs(theta - equations.solve(np.arange(equations.parameters.total))[: len(theta)])
    half = half[: len(theta)] + moved
    own = ParameterBlocks.of(t.effect for t in model.terms)
    terms = (t.with_intervals(half[at]) for t, at in zip(model.terms, own, strict=True))
    return Dynamics(model.robot, tuple(terms))
