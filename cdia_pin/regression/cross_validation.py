"""Cross-validation: each block of time is predicted from a fit to the other blocks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Prediction, rms
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.regression import Regression
from cdia_pin.regression.time_blocks import Block

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
    changes = (equations.change_without(block, range(len(terms))) for block in equations.blocks)
    return rms_of_blocks(regression.design, prediction, regression.whitening.blocks, changes)


def rms_of_blocks(
    design: DesignMatrix, prediction: Prediction, blocks: Sequence[Block], changes: Iterable[Array]
) -> Array:
    """Return the RMS residual of each joint if each block of time is predicted with other parameters, to first order.

    Args:
        design: Columns of effects.
        prediction: Prediction of a fitted model.
        blocks: Samples of each block of time.
        changes: For each block, by how much the parameters differ from those of the model, shape (P,).

    Returns:
        RMS residual [N·m or N], shape (n,).
    """
    experiment, terms = design.experiment, prediction.model.terms
    out = prediction.residual.copy()
    columns = [design.of(t.effect, prediction, np.array(t.theta)) for t in terms]
    parameters = ParameterBlocks.of([t.effect for t in terms])
    for samples, change in zip(blocks, changes, strict=True):
        for term, own, x in zip(terms, parameters, columns, strict=True):
            for i, j in enumerate(term.effect.acts_on(experiment.robot)):
                out[samples, j] -= x[samples, i, :] @ change[own]
    return rms(out, experiment.informative)
