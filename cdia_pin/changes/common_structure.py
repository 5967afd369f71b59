"""Structure that several logs may have in common: rigid bodies, friction, and smooth functions of the motion.

It is not searched for, but fitted at once. Each column has a prior standard deviation: that of an effect of the
vocabulary is the joint's own torque, that of a smooth function is the residual of the vocabulary. Without these priors,
large smooth functions that cancel in one log could imitate a change in the other.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect, LinkInertia
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.friction_memory import bent
from cdia_pin.regression.shared_parameters import ColumnGroup
from cdia_pin.selection.candidates import enumerate_candidates
from cdia_pin.selection.discovery_settings import DiscoverySettings

Array = NDArray[np.float64]

NEURONS = 7  # radial basis functions [1] over a signal of a joint; they resolve a sixth of its range
REACHES = (0.01, 0.03, 0.1, 0.3)  # reaches of friction with memory, over the joint's travel [1]
SLOW = 0.05  # speed over the joint's usual speed [1] within which smooth functions change with the direction


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


def smooth_functions(experiment: Experiment, prediction: Prediction, size: Array) -> list[ColumnGroup]:
    """Return smooth functions of each joint's motion and load, and of the other joints' positions.

    Args:
        experiment: The conditioned logs.
        prediction: Prediction of the model.
        size: Prior standard deviation of their torque on each joint [N·m or N], shape (n,).
    """
    _, q, v, a = experiment.compared_motion()
    pairs = zip(experiment.segments, prediction.torques, strict=True)
    load = np.concatenate([s.motion.sampled(t.actuator) for s, t in pairs])
    out = []
    for j in range(experiment.robot.n):
        usual = max(float(np.percentile(np.abs(v[:, j]), 95)), 1e-9)
        direction = np.tanh(v[:, j] / (SLOW * usual))[:, None]
        at_q, at_v, at_load = (_bases(s[:, j]) for s in (q, v, load))
        posture = [
            f(m * q[:, k]) for k in range(q.shape[1]) if k != j for f in (np.sin, np.cos) for m in (1, 2)
        ]
        ways = [at_q, np.column_stack(posture)] if posture else [at_q]
        both = [w for way in ways for w in (way, way * direction)]
        raw = np.column_stack([*both, at_q * v[:, [j]] / usual, at_v, at_load, np.abs(a[:, [j]])])
        travel = max(float(np.ptp(s.motion.q[:, j])) for s in experiment.segments)
        memory = [bent(experiment, j, r * max(travel, 1e-9)) for r in REACHES]
        raw = np.column_stack([raw, *memory])
        columns = raw / np.maximum(np.sqrt(np.mean(raw**2, axis=0)), 1e-9)
        out.append(ColumnGroup({j: columns}, np.full(columns.shape[1], max(float(size[j]), 1e-12))))
    return out


def _bases(signal: Array) -> Array:
    low, high = np.percentile(signal, [0.5, 99.5])
    width = (high - low) / (NEURONS - 1) or 1.0
    return np.asarray(np.exp(-(((signal[:, None] - np.linspace(low, high, NEURONS)) / width) ** 2)))
