"""Structural rank: the directions that effects span on motions that excite everything, whatever a log shows."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect, State
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

STATES = 300  # random states, far more than any effect has parameters
SPEED, ACCELERATION = 1.0, 3.0  # [rad/s or m/s], [rad/s² or m/s²], their standard deviations
NEGLIGIBLE = 1e-5  # singular value beside the largest, of columns of unit norm, that is rounding


def rank(columns: Array, negligible: float = NEGLIGIBLE) -> int:
    """Return how many directions columns span, each scaled to unit norm.

    Args:
        columns: Torque per unit of each parameter, shape (K, p).
        negligible: Singular value that is rounding, over the largest [1].
    """
    norm = np.linalg.norm(columns, axis=0)
    seen = columns[:, norm > NEGLIGIBLE * norm.max(initial=0.0)]
    values = (
        np.linalg.svd(seen / np.linalg.norm(seen, axis=0), compute_uv=False) if seen.shape[1] else np.zeros(0)
    )
    return int(np.sum(values > negligible * values.max(initial=0.0)))


@lru_cache(maxsize=512)
def generic_rank(robot: RobotModel, *effects: Effect) -> int:
    """Return how many directions effects span together on motions that excite everything.

    Args:
        robot: The arm.
        effects: The effects.
    """
    return rank(np.column_stack([_columns(robot, e) for e in effects]))


def contains(robot: RobotModel, wide: Effect, narrow: Effect) -> bool:
    """Return True if one effect can produce on every motion any torque that another can.

    Args:
        robot: The arm.
        wide: The effect that may contain the other.
        narrow: The other.
    """
    return generic_rank(robot, wide, narrow) == generic_rank(robot, wide)


def are_alike(robot: RobotModel, one: Effect, other: Effect) -> bool:
    """Return True if no motion of this arm distinguishes two effects.

    Args:
        robot: The arm.
        one: One effect.
        other: The other.
    """
    return contains(robot, one, other) and contains(robot, other, one)


def torque_elsewhere(robot: RobotModel, effect: Effect, covariance: Array) -> Array:
    """Return the RMS torque of an effect whose parameters have a covariance, on motions that excite everything.

    Args:
        robot: The robot.
        effect: The effect.
        covariance: Covariance of its parameters, or θθᵀ if they are known, shape (p, p).

    Returns:
        Torque [N·m or N], shape (n,).
    """
    phi = _columns(robot, effect).reshape(STATES, robot.n, -1)
    return np.asarray(np.sqrt(np.abs(np.einsum("knp,pq,knq->n", phi, covariance, phi)) / STATES))


@lru_cache(maxsize=512)
def _columns(robot: RobotModel, effect: Effect) -> Array:
    """Return the torque per unit of each parameter at random states, all joints below each other, shape (K·n, p)."""
    phi = effect.basis(random_states(robot))
    return phi.reshape(-1, phi.shape[2])


@lru_cache(maxsize=8)
def random_states(robot: RobotModel) -> State:
    """Return states that excite everything, always the same for one robot, shapes (K, n).

    Args:
        robot: The arm.
    """
    rng = np.random.default_rng(0)
    lower, upper = robot.limits.usual_range(robot.is_prismatic)
    q = rng.uniform(lower, upper, (STATES, robot.n))
    v, a = SPEED * rng.standard_normal(q.shape), ACCELERATION * rng.standard_normal(q.shape)
    time = np.arange(STATES, dtype=float)
    return State(robot, q, v, a, robot.inverse_dynamics(q, v, a), time)
