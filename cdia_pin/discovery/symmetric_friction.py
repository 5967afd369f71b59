"""Friction that is the same in both directions has the simpler name: Coulomb and viscous friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cdia_pin.discovery.trust import Repeat
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import AsymmetricFriction, CoulombFriction, Term, ViscousFriction
from cdia_pin.selection.problem import Problem

CERTAIN = 3.0  # difference between the directions over its standard deviation [1], above which it is real
# Difference between the directions over their sum [1], below which nobody would call it asymmetric.
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


def _is_asymmetric(repeat: Repeat, term: Term) -> bool:
    """Tell whether levels or coefficients differ between the directions, surely and notably."""
    theta, covariance = repeat.theta(term), repeat.covariance(term)
    for k in (0, 2):
        difference = abs(theta[k] - theta[k + 1])
        variance = covariance[k, k] + covariance[k + 1, k + 1] - 2 * covariance[k, k + 1]
        certain = difference > CERTAIN * np.sqrt(max(float(variance), 0.0))
        if certain and difference > NOTABLE * abs(theta[k] + theta[k + 1]):
            return True
    return False
