"""How well the scale of the measured torques is known, and what follows for the effects that are found in them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import ActuatorGain, Channel, Effect, Signal, Term
from cdia_pin.regression.experiment import Experiment
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


def effort_tolerance(experiment: Experiment, effect: Effect, torque: Array) -> float:
    """Return the tolerance of the scale of the torques that an effect is measured by, 95 % [1].

    Args:
        experiment: The logs.
        effect: The effect.
        torque: RMS torque of the effect [N·m or N], shape (n,).
    """
    return max((scale_error(effect, torque, t) for t in _stated(experiment)), default=0.0)


def scale_error(effect: Effect, torque: Array, by_joint: Array) -> float:
    """Return the relative error of an effect's parameters that follows from that of the torques [1].

    Joints count by the square of the effect's torque, as they do in its fit.

    Args:
        effect: The effect. What has no torque as unit, such as a gain or a delay, does not depend on the scale.
        torque: RMS torque of the effect [N·m or N], shape (n,).
        by_joint: Relative error of the scale of each joint's torque [1], shape (n,).
    """
    if effect.traits.channel is not Channel.JOINT_TORQUE or Signal.TORQUE in effect.traits.depends_on:
        return 0.0
    weight = torque**2 / max(float(np.sum(torque**2)), 1e-300)
    return float(weight @ by_joint)


def stated_tolerance(experiment: Experiment) -> Array:
    """Return the tolerance of the scale of each joint's torque, 95 % [1], zero where nobody states it, shape (n,).

    Args:
        experiment: The logs; the least certain one counts.
    """
    stated = _stated(experiment)
    return np.max(stated, axis=0) if stated else np.zeros(experiment.robot.n)


def doubted_scale(gains: Iterable[Term], robot: RobotModel) -> Array:
    """Return by how much other effects change if gains are left out [1], shape (n,).

    A model with a gain α states an effect of the measured torque f as (1 + α) f.

    Args:
        gains: The terms of a model that may be something else; those that are no gain say nothing.
        robot: The arm.
    """
    out = np.zeros(robot.n)
    for term in gains:
        if isinstance(term.effect, ActuatorGain):
            out[robot.joint_index(term.effect.joint)] = abs(term.theta[0]) / (1 + term.theta[0])
    return out


def _stated(experiment: Experiment) -> list[Array]:
    """Return the tolerances of the logs that state one, shape (n,) each."""
    return [s.motion.effort_tolerance for s in experiment.segments if s.motion.effort_tolerance is not None]
