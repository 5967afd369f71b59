"""The smallest change of a link that gives the torque of a fitted body whose mass the motion does not show.

A motion may show the first moments of a body and not its mass. The fit then ends at any mass, and its interval holds
zero. The torque is the same, but a simulator would have a link of a wrong mass.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import ALWAYS, State, Term
from cdia_pin.effects.body import Body
from cdia_pin.effects.rigid_body import RigidBody
from cdia_pin.exports.torque_left_out import states_of
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.physical_consistency import consistent_parameters
from cdia_pin.robot.inertia import pseudo_inertia
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# With a tenth the error of four measured legs grows by 1.5 % at most.
SAME = 0.1  # difference of the torque over what the model leaves [1] that counts as much as a change by the whole link
LEAST_LEFT = 1e-6  # [1], over the measured torque: a model that leaves nothing must not divide by zero
LEAST_MASS = 0.02  # [1], of the arm's mass: a URDF's mass of a link may be a placeholder
LEAST_RADIUS = 0.03  # [m], radius of gyration of a link, likewise
LEAST_TORQUE = 1e-12  # [N·m or N], below every torque, for a joint that has none


def with_least_bodies(model: Dynamics) -> tuple[Dynamics, tuple[Term, ...]]:
    """Return a model in which bodies of unknown mass are as small as their torque allows, and the terms they replace.

    The bodies stay possible ones. A model that remembers no motion stays as it is, and so do bodies without intervals.

    Args:
        model: The model, with the logs that it was learned from.
    """
    unknown = tuple(t for t in model.terms if _has_unknown_mass(t))
    if not unknown or not model.learned_from:
        return model, ()
    states = states_of(model)
    left = _left(model, states)
    terms = tuple(_least(t, model, states, left) if _has_unknown_mass(t) else t for t in model.terms)
    return replace(model, terms=terms), unknown


def _has_unknown_mass(term: Term) -> bool:
    """Tell whether a term is a body, and the interval of its mass holds zero."""
    if not isinstance(term.effect, Body) or term.profile != ALWAYS or not term.ci95:
        return False
    low, high = term.ci95[0]
    return low <= 0.0 <= high


def _left(model: Dynamics, states: list[State]) -> Array:
    """Return the RMS torque of each joint that a model leaves of the motions [N·m or N], shape (n,)."""
    measured = np.vstack([m.effort for m in model.learned_from])
    predicted = np.vstack([model.torques(x).reading for x in states])
    every = np.ones(measured.shape, bool)
    return np.maximum(rms(measured - predicted, every), LEAST_LEFT * rms(measured, every) + LEAST_TORQUE)


def _least(term: Term, model: Dynamics, states: list[State], left: Array) -> Term:
    """Return a body with the least change of its link that gives nearly the torque of a term."""
    basis = [term.effect.basis(model.true_state(x)) / (SAME * left[:, None]) for x in states]
    rows = np.concatenate([b.reshape(-1, b.shape[2]) for b in basis])
    gram = rows.T @ rows / sum(map(len, basis))
    prior = np.diag(1.0 / _sizes(term.effect.bodies[0], model.robot) ** 2)
    theta = consistent_parameters(gram + prior, gram @ np.array(term.theta), [term.effect], model.robot)
    return term.with_theta(theta)


def _sizes(body: RigidBody, robot: RobotModel) -> Array:
    """Return mass, first moments and inertias of a link as large as they can be, shape (10,)."""
    pseudo = pseudo_inertia(robot.inertial_parameters[body.carrier(robot)])
    mass = max(pseudo[3, 3], LEAST_MASS * robot.total_mass)
    reach = np.sqrt(max(np.trace(pseudo[:3, :3]) / mass, LEAST_RADIUS**2))
    return np.asarray(mass * np.array([1.0] + [reach] * 3 + [reach**2] * 6))
