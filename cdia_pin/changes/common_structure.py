"""Structure that several logs may have in common: every effect of the vocabulary, and every rigid body.

It is not searched for, but fitted at once. The prior standard deviation of each effect is the joint's own torque.
Without these priors, large effects that cancel in one log could imitate a change in the other.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect, LinkInertia
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.shared_parameters import ColumnGroup
from cdia_pin.selection.candidates import enumerate_candidates
from cdia_pin.selection.discovery_settings import DiscoverySettings

Array = NDArray[np.float64]


def common_effects(
    experiment: Experiment, prediction: Prediction, columns: DesignMatrix
) -> list[ColumnGroup]:
    """Return the columns of the vocabulary, each effect in a few shapes, with the joint's own torque as prior.

    Args:
        experiment: The conditioned logs.
        prediction: Prediction of the model.
        columns: Columns of effects.
    """
    robot = experiment.robot
    families = enumerate_candidates(experiment, prediction, DiscoverySettings())
    bodies = [LinkInertia(j) for j in robot.joints]
    present = {t.effect: np.array(t.theta) for t in prediction.model.terms}
    effects: list[Effect] = list(dict.fromkeys([*present, *(e for f in families for e in _few(f)), *bodies]))
    torque = np.maximum(rms(experiment.measured, experiment.informative), 1e-9)
    out = []
    for effect in effects:
        x, joints = columns.of(effect, prediction, present.get(effect)), effect.acts_on(robot)
        of_unit = np.sqrt(np.mean(x**2, axis=0)) / torque[list(joints)][:, None]  # (joints, p)
        scale = np.minimum(effect.prior_scale(robot), 1.0 / np.maximum(of_unit.max(axis=0), 1e-12))
        out.append(ColumnGroup({j: x[:, i, :] for i, j in enumerate(joints)}, scale))
    return out


def _few(family: list[Effect]) -> list[Effect]:
    """Return the first, the middle and the last of an effect's shapes."""
    return list(dict.fromkeys(family[k] for k in (0, len(family) // 2, -1)))
