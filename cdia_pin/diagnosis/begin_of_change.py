"""From when on a log shows a change, of which another log tells how large it is.

A window that begins before the change holds two arms. What is found in it is too small, or has no name, or another one.
The samples tell where it begins: before, the torque is better predicted as it was in the healthy runs, and worse with
the change.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes import Changes
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, TorqueOffset
from cdia_pin.effects.refinements import PLAIN_FRICTION
from cdia_pin.logs.motion import Motion
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.regression.rest import RestSettings

Array = NDArray[np.float64]

LEAST_ERROR = 1e-12  # [N·m or N], below every measured torque: a joint without error must not divide by zero


def begin_of(healthy: Sequence[Motion], window: Motion, changes: Changes, rest: RestSettings) -> float:
    """Return the time from which on a window shows some changes [s]; its begin if all of it does.

    What the model lacks alike before and after is taken out first: the same effects, and friction and offset of the
    joints concerned, are fitted to the healthy runs. Then the squared error of the changed arm less that of the healthy
    one is summed over the time; the changes begin where this sum is largest. A delay and an encoder's zero, of which no
    column is right far from zero, begin with the window.

    Args:
        healthy: Conditioned healthy runs.
        window: The conditioned log.
        changes: What differs between them.
        rest: Which samples show friction.

    Raises:
        LogError: If nothing of the logs can be compared.
        LinAlgError: If an effect has no finite torque.
    """
    model, terms = changes.model, [c.term for c in changes.changes]
    robot, named = model.robot, [t.effect for t in terms]
    if not all(e.traits.linear for e in named):
        return float(window.time[0])
    joints = sorted({j for e in named for j in e.acts_on(robot)})
    kinds = (*PLAIN_FRICTION, TorqueOffset)
    alike = dict.fromkeys([*named, *(kind(robot.joints[j]) for j in joints for kind in kinds)])
    before, after = (_Torques(model, logs, list(alike), rest) for logs in (healthy, [window]))
    compared = np.array([j not in changes.not_compared for j in robot.joints])
    both = before.counts.any(axis=0) & compared
    was = before.fitted()
    left = np.maximum(rms(before.residual - before.columns @ was, before.counts), LEAST_ERROR)
    as_healthy = after.residual - after.columns @ was
    change = after.columns[..., : sum(e.size for e in named)] @ np.concatenate([t.theta for t in terms])
    lost = ((as_healthy - change) ** 2 - as_healthy**2) / left**2
    summed = np.cumsum(np.where(after.counts & both, lost, 0.0).sum(axis=1))
    last = int(np.argmax(summed))
    return float(after.time[last] if summed[last] > 0.0 else window.time[0])


class _Torques:
    """What a model leaves of some logs, and the torque of effects per unit of their parameters."""

    def __init__(
        self, model: Dynamics, motions: Sequence[Motion], effects: Sequence[Effect], rest: RestSettings
    ) -> None:
        experiment = Experiment.of(model.robot, motions, rest)
        prediction, design = experiment.predict(model), DesignMatrix(experiment)
        self.residual, self.counts = prediction.residual, experiment.informative
        self.time = experiment.compared_motion()[0]
        columns = []
        for effect in effects:
            own = np.zeros((*self.residual.shape, effect.size))
            own[:, list(effect.acts_on(model.robot))] = design.of(effect, prediction)
            columns.append(own)
        self.columns: Array = np.concatenate(columns, axis=2)

    def fitted(self) -> Array:
        """Return the parameters that leave least, each joint over what the model leaves there, shape (p,)."""
        weights = self.counts / np.maximum(rms(self.residual, self.counts), LEAST_ERROR)
        rows = (weights[..., None] * self.columns).reshape(-1, self.columns.shape[-1])
        return np.asarray(np.linalg.lstsq(rows, (weights * self.residual).ravel(), rcond=None)[0])
