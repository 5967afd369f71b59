"""How well the scale of the measured torques is known, and what follows for the effects that are found in them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Channel, Effect, Signal
from cdia_pin.regression.experiment import Experiment

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


def _stated(experiment: Experiment) -> list[Array]:
    """Return the tolerances of the logs that state one, shape (n,) each."""
    return [s.motion.effort_tolerance for s in experiment.segments if s.motion.effort_tolerance is not None]
