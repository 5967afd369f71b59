"""Terms that no arm can have, such as a friction of −5 N·m, or of more than any motor overcomes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics.trajectories import exciting_trajectory
from cdia_pin.effects import State, Term
from cdia_pin.effects.weight import largest_weight
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# [1], torque of a term over what its joint can give. An arm cannot move long before; a payload in grams, or a number
# with three zeros too many, is beyond.
MOST_OVERLOAD = 10.0
DURATION, STEP = 10.0, 0.1  # [s], of the motion that a term is judged on
ROUNDING = 1e-6  # [1], by which an estimate may pass a bound, relative to its largest parameter


def unphysical(term: Term, robot: RobotModel, tolerance: float = ROUNDING) -> str:
    """Return why no arm can have a term; empty if one can.

    Args:
        term: An effect with numbers.
        robot: The arm.
        tolerance: By how much a parameter may pass a bound, relative to the largest parameter [1].
    """
    theta = np.array(term.theta)
    nearest = term.effect.nearest_physical(theta, robot)
    if term.effect.is_physical(theta, robot) or np.allclose(
        theta, nearest, rtol=0.0, atol=tolerance * float(np.abs(theta).max(initial=0.0))
    ):
        return _overload(term, robot)
    outside = []
    rows = zip(term.effect.parameters, theta, *term.effect.bounds(robot), strict=True)
    for parameter, value, lower, upper in rows:
        if not lower <= value <= upper:
            outside.append(f"{parameter.name} = {value:.4g} is not within {lower:g} to {upper:g}")
    return f"{term.label}: " + (", ".join(outside) or "no body has this mass, first moments and inertia")


def _overload(term: Term, robot: RobotModel) -> str:
    """Return by how much a term is beyond what the arm's joints can give; empty where it is not."""
    torque = np.abs(term.effect.torque(_usual_motion(robot), np.array(term.theta))).max(axis=0)
    most = _largest_efforts(robot)
    j = int(np.argmax(torque / most))
    if torque[j] <= MOST_OVERLOAD * most[j]:
        return ""
    unit = "N" if robot.is_prismatic[j] else "N·m"
    return (
        f"{term.label}: its torque reaches {torque[j]:.3g} {unit} at {robot.joints[j]}, more than {MOST_OVERLOAD:g} "
        f"times the {most[j]:.3g} {unit} of the joint"
    )


def _largest_efforts(robot: RobotModel) -> Array:
    """Return what each joint can give [N·m or N], shape (n,); the arm's weight where the URDF states no limit."""
    weight = float(largest_weight(robot).max())
    return np.where(np.isfinite(robot.limits.effort), robot.limits.effort, weight or np.inf)


@lru_cache(maxsize=32)
def _usual_motion(robot: RobotModel) -> State:
    """Return a motion within the limits of the arm."""
    time = np.arange(0.0, DURATION, STEP)
    return State.of(
        robot, *exciting_trajectory(robot, np.random.default_rng(0), duration=DURATION)(time), time=time
    )


def require_physical(faults: Sequence[Term], robot: RobotModel, known: Iterable[Term] = ()) -> None:
    """Refuse faults that no arm can have; one may take away what the model already has.

    Args:
        faults: Terms that are added to the model.
        robot: The arm.
        known: Terms of the model.

    Raises:
        EffectError: If there is one; the message names its parameter and the bounds.
    """
    present = {term.effect: np.array(term.theta) for term in known}
    for fault in faults:
        together = np.array(fault.theta) + present.get(fault.effect, 0.0)
        if why := unphysical(fault.with_theta(together), robot):
            raise EffectError(why)
