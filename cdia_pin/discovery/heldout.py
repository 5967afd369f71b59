"""Errors, on what was fitted and on what was not."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.discovery.candidates import Columns
from cdia_pin.discovery.experiment import Experiment, Prediction
from cdia_pin.discovery.fitting import Whitened, gather

Array = NDArray[np.float64]


def rms(signal: Array, informative: NDArray[np.bool_]) -> Array:
    """Return the root mean square of each joint's signal over the samples that count, shape (n,)."""
    count = np.maximum(informative.sum(axis=0), 1)
    return np.sqrt(np.sum(np.where(informative, signal, 0.0) ** 2, axis=0) / count)


def held_out_rms(experiment: Experiment, columns: Columns, prediction: Prediction, whitened: Whitened) -> Array:
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
