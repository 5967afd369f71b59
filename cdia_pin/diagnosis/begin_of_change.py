"""From when on a log shows a change, of which another log tells how large it is.

A window that begins before the change holds two arms. What is found in it is too small, or has no name, or another one.
The samples tell where it begins: before, the torque is better predicted as it was in the healthy runs, and worse with
the change.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes import Change
from cdia_pin.dynamics import Dynamics
from cdia_pin.logs.motion import Motion
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, rms

Array = NDArray[np.float64]

LEAST_ERROR = 1e-12  # [N·m or N], below every measured torque: a joint without error must not divide by zero


def begin_of(model: Dynamics, healthy: Sequence[Motion], window: Motion, changes: Sequence[Change]) -> float:
    """Return the time from which on a window shows some changes [s].

    What the model lacks alike before and after is taken out first: the same effects are fitted to the healthy runs.
    Then the squared error of the changed arm less that of the healthy one is summed over the time; the changes begin
    where this sum is largest.

    Args:
        model: The model of the arm.
        healthy: Conditioned healthy runs.
        window: The conditioned log.
        changes: What differs between them.
    """
    before, after = _Torques(model, healthy, changes), _Torques(model, [window], changes)
    size = np.maximum(rms(before.residual, before.counts), LEAST_ERROR)
    weights = before.counts / size
    rows = (weights[..., None] * before.columns).reshape(-1, before.columns.shape[-1])
    alike = np.linalg.lstsq(rows, (weights * before.residual).ravel(), rcond=None)[0]
    as_healthy = after.residual - after.columns @ alike
    change = after.columns @ np.concatenate([c.term.theta for c in changes])
    left = np.maximum(rms(before.residual - before.columns @ alike, before.counts), LEAST_ERROR)
    lost = ((as_healthy - change) ** 2 - as_healthy**2) / left**2
    summed = np.cumsum(np.where(after.counts, lost, 0.0).sum(axis=1))
    first = int(np.argmax(summed)) + 1 if summed.max() > 0.0 else 0
    return float(after.time[min(first, len(after.time) - 1)])


class _Torques:
    """What a model leaves of some logs, and the torque of effects per unit of their parameters."""

    def __init__(self, model: Dynamics, motions: Sequence[Motion], changes: Sequence[Change]) -> None:
        experiment = Experiment.of(model.robot, motions)
        prediction, design = experiment.predict(model), DesignMatrix(experiment)
        present = {t.effect: np.array(t.theta) for t in model.terms}
        self.residual, self.counts = prediction.residual, experiment.informative
        self.time = experiment.compared_motion()[0]
        columns = []
        for effect in (c.term.effect for c in changes):
            own = np.zeros((*self.residual.shape, effect.size))
            own[:, list(effect.acts_on(model.robot))] = design.of(effect, prediction, present.get(effect))
            columns.append(own)
        self.columns: Array = np.concatenate(columns, axis=2)
