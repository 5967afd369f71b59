"""The arm with what it is believed to carry, what a decision makes of that, and the torque that it takes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.whole_arm.hypotheses import HYPOTHESES, Hypothesis
from cdia_pin.diagnosis.whole_arm.isolation import ArmDecision
from cdia_pin.diagnosis.whole_arm.trial import is_gone
from cdia_pin.effects import BaseTilt, Term
from cdia_pin.robot.inertia import pseudo_inertia
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

NARROWER = (
    0.8  # [1], volume of new intervals over that of the old ones: each of four parameters narrower by 5 %
)
ROUNDING = 1e-9  # [kg m²], by which an eigenvalue of a pseudo-inertia may fall


def carried(nominal: Nominal, terms: tuple[Term, ...]) -> RobotModel:
    """Return the arm with the load and the tilt that are believed. Without any it is the healthy arm.

    Args:
        nominal: The healthy arm.
        terms: Believed effects of the whole arm: bodies and tilts.
    """
    robot, pi, g = nominal.robot, nominal.robot.inertial_parameters.copy(), nominal.robot.gravity_vector
    if not terms:
        return robot
    for term in terms:
        theta = np.array(term.theta)
        if isinstance(term.effect, BaseTilt):
            g = g + term.effect.tilt(robot, theta)
        pi += term.effect.on_links(theta, robot)
    return robot.with_inertial_parameters(pi).with_gravity(g)


def known(believed: Sequence[Term], found: ArmDecision) -> tuple[Term | None, Array]:
    """Return the believed effect that a decision is about, and its estimated parameters; zero if it is not believed.

    Args:
        believed: Believed effects of the whole arm.
        found: A decision for one of the hypotheses.
    """
    hypothesis = _hypothesis(found)
    old = next((b for b in believed if b.effect == hypothesis.effect), None)
    return old, np.zeros(hypothesis.shown) if old is None else np.array(old.theta[: hypothesis.shown])


def changed(believed: Sequence[Term], found: ArmDecision) -> Term:
    """Return the effect of a decision as it would be with the change that was found.

    Args:
        believed: Believed effects of the whole arm.
        found: A decision for one of the hypotheses.
    """
    _, shown = known(believed, found)
    return _hypothesis(found).term(shown + found.theta, found.half)


def ends(believed: Sequence[Term], found: ArmDecision) -> bool:
    """Tell whether a decision is that what was believed is gone; its numbers may miss zero to either side.

    Args:
        believed: Believed effects of the whole arm.
        found: A decision for one of the hypotheses.
    """
    old, shown = known(believed, found)
    return old is not None and is_gone(shown, found)


def refines(believed: Sequence[Term], found: ArmDecision, robot: RobotModel) -> bool:
    """Tell whether the collected samples give a believed effect other numbers, or narrower intervals.

    That it is gone is left to alarms, which say so.

    Args:
        believed: Believed effects of the whole arm.
        found: A decision for the hypothesis of the effect.
        robot: The healthy arm.
    """
    if found.index is None or ends(believed, found):
        return False
    old, _ = known(believed, found)
    now = changed(believed, found)
    is_narrower = old is not None and np.prod(found.half) < NARROWER * np.prod(
        old.half_widths[: len(found.half)]
    )
    return (found.is_sure or is_narrower) and is_possible(now, robot)


def _hypothesis(found: ArmDecision) -> Hypothesis:
    assert found.index is not None
    return HYPOTHESES[found.index]


def is_possible(term: Term, robot: RobotModel) -> bool:
    """Tell whether the arm can have an effect of the whole arm.

    With a body, no link may be further from a possible body than it is by itself. Links that a URDF states or healthy
    runs corrected need not be possible bodies, since the torques show some sums of their parameters alone.

    Args:
        term: The effect.
        robot: The healthy arm.
    """
    effect, theta = term.effect, np.array(term.theta)
    if not effect.bodies:
        return effect.is_physical(theta, robot)
    lower, upper = effect.bounds(robot)
    now = robot.inertial_parameters
    before, after = (
        np.linalg.eigvalsh(pseudo_inertia(pi))[:, 0] for pi in (now, now + effect.on_links(theta, robot))
    )
    within = (lower <= theta) & (theta <= upper)
    return bool(within.all() and (after >= np.minimum(before, 0.0) - ROUNDING).all())


def added_torque(nominal: RobotModel, now: RobotModel, q: Array, v: Array, tau: Array) -> Array:
    """Return what the arm as it is needs besides a torque to move as the healthy one would [N·m or N], shape (n,).

    Args:
        nominal: The healthy arm.
        now: The arm as it is.
        q: Positions [rad or m], shape (n,).
        v: Velocities [rad/s or m/s], shape (n,).
        tau: The torque [N·m or N], shape (n,).
    """
    M, nle = (np.array(x) for x in nominal.rigid_terms(q, v))
    a = np.linalg.solve(M, tau - nle)
    M_now, nle_now = now.rigid_terms(q, v)
    return np.asarray((M_now - M) @ a + nle_now - nle)
