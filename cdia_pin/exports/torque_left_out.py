"""The torque of what a file cannot hold, over the motion that the model remembers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.dynamics.simulator_values import Beyond, SimulatorValues
from cdia_pin.effects import State
from cdia_pin.logs.motion import Motion, names_of

Array = NDArray[np.float64]


def torque_left_out(values: SimulatorValues, model: Dynamics) -> dict[str, dict[str, float]]:
    """Compute the torque that a file lacks, RMS over all motions that the model was learned from.

    Args:
        values: What the file holds.
        model: The model.

    Returns:
        RMS torque [N·m or N] by joint, for the label of each term that is not held or not whole. It is empty if the
        model remembers no motion.
    """
    states = states_of(model)
    if not states:
        return {}
    predicted = [model.torques(x).reading for x in states]
    out = {}
    for label, beyond in values.beyond.items():
        held = _without(model, beyond)
        lacking = [p - held.torques(x).reading for p, x in zip(predicted, states, strict=True)]
        out[label] = model.robot.by_joint(np.sqrt(np.mean(np.square(np.vstack(lacking)), axis=0)))
    return out


def states_of(model: Dynamics) -> list[State]:
    """Return the states along all motions that a model was learned from, N samples each.

    Args:
        model: The model.
    """
    motions = model.learned_from
    return [_state(m, name, model) for m, name in zip(motions, names_of(motions), strict=True)]


def _without(model: Dynamics, beyond: Beyond) -> Dynamics:
    """Return the model with what the file holds of a term in place of the term."""
    others = tuple(t for t in model.terms if t is not beyond.term)
    return Dynamics(model.robot, others + beyond.written)


def _state(motion: Motion, name: str, model: Dynamics) -> State:
    """Return the state along a motion, N samples."""
    zero = np.zeros_like(motion.q)
    return State(
        model.robot,
        motion.q,
        motion.v,
        motion.a,
        zero,
        motion.time,
        log=name,
        temperature=motion.temperature,
    )
