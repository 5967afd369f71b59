"""Structure that several logs may have in common: every effect of the vocabulary, and every rigid body.

It is not searched for, but fitted at once. The prior standard deviation of each effect is the joint's own torque, or a
share of it for effects that not every arm has. Without these priors, large effects that cancel in one log could imitate
a change in the other. If rare effects may be large, they take in a change in short logs.
"""

from __future__ import annotations

from collections.abc import Callable, Container

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import (
    BearingFriction,
    CoulombFriction,
    Effect,
    EffortDelay,
    LinkInertia,
    RotorInertia,
    Term,
    TorqueOffset,
    ViscousFriction,
)
from cdia_pin.effects.rigid_body import RigidBody
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.regression.shared_parameters import ColumnGroup, SharedRegression
from cdia_pin.robot.model import RobotModel
from cdia_pin.selection.candidates import enumerate_candidates
from cdia_pin.selection.discovery_settings import DiscoverySettings

Array = NDArray[np.float64]

PLAIN = (CoulombFriction, ViscousFriction, TorqueOffset)  # what nearly every joint has, besides rigid bodies
# What every arm has, and every recorder: if the delay of the logs before were rare, it would be missing in those after.
EVERYWHERE = (RigidBody, RotorInertia, BearingFriction, EffortDelay, *PLAIN)


def is_rare(effect: Effect, present: Container[Effect]) -> bool:
    """Tell whether neither every arm nor the model has an effect.

    Args:
        effect: The effect.
        present: Effects of the model.
    """
    return effect not in present and not isinstance(effect, EVERYWHERE)


def plain_effects(robot: RobotModel) -> list[Effect]:
    """Return what every arm has: bodies, rotors, Coulomb and viscous friction, and offsets.

    Args:
        robot: The arm.
    """
    kinds = (LinkInertia, RotorInertia, *PLAIN)
    return [kind(j) for kind in kinds for j in robot.joints]


def plainly_fitted(model: Dynamics, experiment: Experiment) -> Dynamics:
    """Return a model with what every arm has, fitted to logs.

    A motor that weakens scales the friction of its joint too. So effects that depend on the torque need a model whose
    torque is about right; that of a bare URDF has no friction.

    Args:
        model: The model as it is known; its terms stay as they are.
        experiment: The conditioned logs.
    """
    robot, prediction = experiment.robot, experiment.predict(model)
    effects = [e for e in plain_effects(robot) if e not in {t.effect for t in model.terms}]
    size = np.maximum(rms(prediction.residual, experiment.informative), 1e-12)
    theta = SharedRegression.of(
        [ColumnGroup.of(e, experiment.columns(e, prediction), robot, e.prior_scale(robot)) for e in effects],
        prediction.residual,
        lambda j, x: np.where(experiment.informative[:, [j]], x / size[j], 0.0),
    ).theta()
    fitted = zip(effects, ParameterBlocks.of(effects).split(theta), strict=True)
    return Dynamics(robot, (*model.terms, *(Term(e, tuple(part)) for e, part in fitted)))


def common_effects(
    experiment: Experiment,
    prediction: Prediction,
    columns: DesignMatrix,
    wanted: Callable[[Effect], bool] = lambda _: True,
    rare: float = 1.0,
) -> list[ColumnGroup]:
    """Return the columns of the vocabulary, each effect in a few shapes, with the joint's own torque as prior.

    Args:
        experiment: The conditioned logs.
        prediction: Prediction of the model.
        columns: Columns of effects.
        wanted: Returns True for effects that are common; all are if omitted.
        rare: Prior standard deviation of an effect that neither every arm nor the model has, over that of others [1].
    """
    robot = experiment.robot
    families = enumerate_candidates(experiment, prediction, DiscoverySettings())
    bodies = [LinkInertia(j) for j in robot.joints]
    present = {t.effect: np.array(t.theta) for t in prediction.model.terms}
    effects: list[Effect] = list(dict.fromkeys([*present, *(e for f in families for e in _few(f)), *bodies]))
    torque = np.maximum(rms(experiment.measured, experiment.informative), 1e-9)
    out = []
    for effect in filter(wanted, effects):
        # exact columns: means over both sides would differ from those that depend on the torque, on one side alone
        theta = present.get(effect, np.zeros(effect.size))
        x, joints = columns.of(effect, prediction, theta), effect.acts_on(robot)
        of_unit = np.sqrt(np.mean(x**2, axis=0)) / torque[list(joints)][:, None]  # (joints, p)
        share = rare if is_rare(effect, present) else 1.0
        scale = share * np.minimum(effect.prior_scale(robot), 1.0 / np.maximum(of_unit.max(axis=0), 1e-12))
        out.append(ColumnGroup.of(effect, x, robot, scale))
    return out


def _few(family: list[Effect]) -> list[Effect]:
    """Return the first, the middle and the last of an effect's shapes."""
    return list(dict.fromkeys(family[k] for k in (0, len(family) // 2, -1)))
