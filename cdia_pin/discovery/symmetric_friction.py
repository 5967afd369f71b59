"""Friction that is the same in both directions has the simpler name: Coulomb and viscous friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cdia_pin.discovery.trust import Repeat
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import AsymmetricFriction, CoulombFriction, Term, ViscousFriction
from cdia_pin.selection.problem import Problem

CERTAIN = 3.0  # difference between the directions over its standard deviation [1], above which it is real
# RMS torque of what differs between the directions over that of the friction [1], below which nobody would call it
# asymmetric.
NOTABLE = 0.1


def with_symmetric_friction(logs: Problem, model: Dynamics, given: Dynamics) -> Dynamics:
    """Return a model in which friction that hardly depends on the direction is Coulomb and viscous friction.

    Args:
        logs: The logs.
        model: The fitted model.
        given: The model before the discovery; its terms stay as they are.
    """
    known, present = ({t.label for t in m.terms} for m in (given, model))
    repeat = Repeat(logs.design, model, logs.settings)
    terms: list[Term] = []
    for term in model.terms:
        parts = [] if term.label in known else _both_directions(term)
        if not parts or {p.label for p in parts} & present or _is_asymmetric(repeat, term):
            parts = [term]
        terms += parts
    return replace(model, terms=tuple(terms)) if len(terms) != len(model.terms) else model


def _both_directions(term: Term) -> list[Term]:
    """Return Coulomb and viscous friction of the mean of both directions; nothing for a term of another kind."""
    if not isinstance(term.effect, AsymmetricFriction):
        return []
    level, coefficient = (max(float(np.mean(term.theta[k : k + 2])), 0.0) for k in (0, 2))
    joint = term.effect.joint
    return [Term(CoulombFriction(joint), (level,)), Term(ViscousFriction(joint), (coefficient,))]


def _is_asymmetric(whole: Repeat, term: Term) -> bool:
    """Tell whether the directions differ notably, surely, and in both halves of the log as far as they can show it."""
    theta = np.array(term.theta)
    mean = np.repeat([theta[:2].mean(), theta[2:].mean()], 2)
    if np.max(whole.torque(term, theta - mean)) <= NOTABLE * np.max(whole.torque(term, theta)):
        return False
    return any(_differ(whole, term, k) for k in (0, 2))


def _differ(whole: Repeat, term: Term, k: int) -> bool:
    """Tell whether two parameters differ in the whole log, and alike in each half that could show it."""
    difference, spread = _difference(whole, term, k)
    if abs(difference) <= CERTAIN * spread:
        return False
    for value, uncertainty in (_difference(half, term, k) for half in whole.halves):
        could = abs(difference) >= 2 * CERTAIN * uncertainty
        if could and value * np.sign(difference) <= CERTAIN * uncertainty:
            return False
    return True


def _difference(repeat: Repeat, term: Term, k: int) -> tuple[float, float]:
    """Return the difference of two neighbouring parameters, and its standard deviation."""
    theta, covariance = repeat.theta(term), repeat.covariance(term)
    variance = covariance[k, k] + covariance[k + 1, k + 1] - 2 * covariance[k, k + 1]
    return float(theta[k] - theta[k + 1]), float(np.sqrt(max(variance, 0.0)))
