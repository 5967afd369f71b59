"""Cross-validation: each block of time is predicted from a fit to the other blocks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.regression.experiment import Prediction, rms
from cdia_pin.regression.regression import Regression

Array = NDArray[np.float64]


def held_out_rms(regression: Regression, prediction: Prediction) -> Array:
    """Return the held-out RMS residual of each joint: every block of time is predicted by a fit to the other blocks.

    Blocks are left out of the equations, not of the motion: a splice of raw motion would create false accelerations.
    Nonlinear effects are linearised at the fit to all blocks.

    Args:
        regression: The conditioned logs and their noise.
        prediction: Prediction of a fitted model.

    Returns:
        RMS residual [N·m or N], shape (n,).
    """
    experiment, terms = regression.experiment, prediction.model.terms
    if not terms:
        return rms(prediction.residual, experiment.informative)
    equations = regression.normal_equations(prediction, [t.effect for t in terms])
    every = range(len(terms))
    out = prediction.residual.copy()
    columns = [regression.design.of(t.effect, prediction, np.array(t.theta)) for t in terms]
    for block, samples in zip(equations.blocks, regression.whitening.blocks, strict=True):
        change = equations.change_without(block, every)
        for term, own, x in zip(terms, equations.parameters, columns, strict=True):
            for i, j in enumerate(term.effect.acts_on(experiment.robot)):
                out[samples, j] -= x[samples, i, :] @ change[own]
    return rms(out, experiment.informative)
