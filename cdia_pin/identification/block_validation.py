"""Cross-validation over blocks of time chooses the strength of the prior and the friction laws."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.identification.estimate import Estimate, Fitter, constrained, unconstrained
from cdia_pin.identification.prior import precision
from cdia_pin.regression.cross_validation import rms_of_blocks
from cdia_pin.regression.normal_equations import NormalEquations

Array = NDArray[np.float64]

# Strengths of the prior that are compared [1]; at the least one, links are right to a third.
STRENGTHS = tuple(float(s) for s in 10.0 ** np.arange(1, 5.5, 0.5))


def block_errors(total: Array, blocks: Array, prior: Array) -> Array:
    """Return the held-out sum of squares of each block: it is predicted from the other blocks.

    Args:
        total: Normal equations of all blocks, shape (P + 1, P + 1).
        blocks: Normal equations of each block, shape (B, P + 1, P + 1).
        prior: Precision of the prior, shape (P, P).

    Returns:
        In variances of the noise [1], shape (B,).
    """
    out = []
    for block in blocks:
        v = np.append(unconstrained(total - block, prior), -1.0)
        out.append(float(v @ block @ v))
    return np.array(out)


def is_better(after: Array, before: Array) -> bool:
    """Return True if blocks are predicted better by more than chance.

    Args:
        after: Held-out sum of squares of each block with the change [1], shape (B,).
        before: Held-out sum of squares of each block without it [1], shape (B,).
    """
    gain = before - after
    return bool(gain.sum() > gain.std(ddof=1) * np.sqrt(len(gain)))


def choose_strength(fitter: Fitter, estimate: Estimate) -> float:
    """Return the largest strength of the prior that predicts held-out blocks as well as the best one, up to chance.

    Of models that predict equally well, the one nearest to the URDF is the safest where the motion shows little.

    Args:
        fitter: Fitter of the experiment.
        estimate: Estimate whose normal equations are used.

    Returns:
        Strength [1], one of `STRENGTHS`.
    """
    equations = estimate.equations
    errors = [
        block_errors(
            equations.total,
            equations.blocks,
            precision(equations, fitter.experiment, estimate.whitening, strength),
        )
        for strength in STRENGTHS
    ]
    best = errors[int(np.argmin([e.sum() for e in errors]))]
    good = [s for s, e in zip(STRENGTHS, errors, strict=True) if not is_better(best, e)]
    return max(good)


def held_out_rms(fitter: Fitter, estimate: Estimate) -> Array:
    """Return the held-out RMS residual of each joint: each block is predicted from a fit to the other blocks.

    Nonlinear effects are linearised at the fit to all blocks.

    Args:
        fitter: Fitter of the experiment.
        estimate: The final estimate.

    Returns:
        In N·m or N, shape (n,).
    """
    equations = estimate.equations
    changes = (
        constrained(equations, equations.total - block, estimate.prior) - estimate.theta
        for block in equations.blocks
    )
    return rms_of_blocks(fitter.design, fitter.experiment.predict(estimate.model), fitter.blocks, changes)


def of_effects(equations: NormalEquations, chosen: Sequence[int]) -> NDArray[np.intp]:
    """Return the positions of the columns of some effects and of the response.

    Args:
        equations: Normal equations.
        chosen: Indices of the effects.

    Returns:
        Shape (p + 1,).
    """
    return np.append(equations.columns(chosen), len(equations.total) - 1)
