"""Cross-validation over blocks of time: how firmly to hold bodies to the URDF, and which laws earn their place."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.identification.estimate import Estimate, Fitter, constrained, unconstrained
from cdia_pin.identification.prior import precision
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.normal_equations import NormalEquations

Array = NDArray[np.float64]

STRENGTHS = tuple(float(s) for s in 10.0 ** np.arange(1, 5.5, 0.5))  # at least: links are right to a third


def block_errors(total: Array, blocks: Array, prior: Array) -> Array:
    """Return the sum of squares of each block when it is predicted from the others, shape (B,).

    Args:
        total: Normal equations of all blocks, shape (P + 1, P + 1).
        blocks: Those of each, shape (B, P + 1, P + 1).
        prior: Precision of the prior, shape (P, P).
    """
    out = []
    for block in blocks:
        v = np.append(unconstrained(total - block, prior), -1.0)
        out.append(float(v @ block @ v))
    return np.array(out)


def is_better(after: Array, before: Array) -> bool:
    """Tell whether blocks are predicted better by more than chance has it, arrays of shape (B,)."""
    gain = before - after
    return bool(gain.sum() > gain.std(ddof=1) * np.sqrt(len(gain)))


def choose_strength(fitter: Fitter, estimate: Estimate) -> float:
    """Return the strongest hold on the URDF which predicts unseen blocks no worse than the best does, but by chance.

    Of models that predict alike the one nearest to the URDF is the safest where the motion says little.
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
    """Return the RMS residual of each joint when each block is predicted from a fit of the others, shape (n,).

    Effects that are not linear are taken to first order around the fit to all blocks.
    """
    experiment, equations = fitter.experiment, estimate.equations
    prediction = experiment.predict(estimate.model)
    out = prediction.residual.copy()
    columns = [fitter.design.of(t.effect, prediction, np.array(t.theta)) for t in estimate.model.terms]
    for k, block in enumerate(equations.blocks):
        change = constrained(equations, equations.total - block, estimate.prior) - estimate.theta
        rows = slice(fitter.edges[k], fitter.edges[k + 1])
        for effect, span, x in zip(equations.effects, equations.parameters, columns, strict=True):
            out[rows, list(effect.acts_on(experiment.robot))] -= x[rows] @ change[span]
    return rms(out, experiment.informative)


def of_effects(equations: NormalEquations, chosen: Sequence[int]) -> NDArray[np.intp]:
    """Return the columns of some effects and of the response."""
    return np.append(equations.columns(chosen), len(equations.total) - 1)
