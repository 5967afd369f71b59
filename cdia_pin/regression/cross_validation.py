"""Held-out errors: each block of time predicted from the others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.regression.design_matrix import Columns
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.fitting import Whitened, gather

Array = NDArray[np.float64]


def held_out_rms(
    experiment: Experiment, columns: Columns, prediction: Prediction, whitened: Whitened
) -> Array:
    """Return the RMS of each joint when every block of time is predicted by a fit to the others.

    Blocks are contiguous: a splice of raw motion would fabricate accelerations. Effects that are not linear are
    taken to first order around the fit to all blocks.

    Returns:
        RMS residual [N·m or N], shape (n,).
    """
    terms = prediction.model.terms
    if not terms:
        return rms(prediction.residual, experiment.informative)
    evidence = gather(experiment, columns, prediction, [t.effect for t in terms], whitened)
    theta = np.concatenate([t.theta for t in terms])
    every = range(len(terms))
    out = prediction.residual.copy()
    x = [columns.of(t.effect, prediction, np.array(t.theta)) for t in terms]
    for block, start, stop in zip(evidence.blocks, whitened.edges[:-1], whitened.edges[1:], strict=True):
        change = evidence.without(block, every) - theta
        at = 0
        for term, column in zip(terms, x, strict=True):
            part = change[at : at + term.effect.size]
            for i, j in enumerate(term.effect.acts_on(experiment.robot)):
                out[start:stop, j] -= column[start:stop, i, :] @ part
            at += term.effect.size
    return rms(out, experiment.informative)
