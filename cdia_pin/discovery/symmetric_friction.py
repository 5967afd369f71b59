"""Friction that is the same in both directions has the simpler name: Coulomb and viscous friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cdia_pin.discovery.trust import Repeat
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import AsymmetricFriction, CoulombFriction, Term, ViscousFriction
from cdia_pin.selection.problem import Problem

CERTAIN = 3.0  # difference between the directions over its standard deviation [1], above which it is real
NOTABLE = (
    0.1  # difference between the directions over their sum [1], below which nobody would call it asymmetric
)


def with_symmetric_friction(logs: Problem, model: Dynamics, given: Dynamics) -> Dynamics:
    """Return a model in which friction that hardly depends on the direction is Coulomb and viscous friction.

    Args:
        logs: The logs.
        model: The fitted model.
        given: The model before the discovery; its terms stay as they are.
    """
    known = {t.label for t in given.terms}
    repeat = Repeat(logs.experiment, model, logs.settings.confidence)
    terms: list[Term] = []
    for term in model.terms:
        plain = (
            (CoulombFriction(j) for j in term.effect.scope),
            (ViscousFriction(j) for j in term.effect.scope),
        )
        parts = [*plain[0], *plain[1]]
        taken = {e.label for e in parts} & {t.label for t in model.terms}
        if (
            not isinstance(term.effect, AsymmetricFriction)
            or term.label in known
            or taken
            or _is_asymmetric(repeat, term)
        ):
            terms.append(term)
            continue
        level, coefficient = (max(float(np.mean(term.theta[k : k + 2])), 0.0) for k in (0, 2))
        terms += [Term(parts[0], (level,)), Term(parts[1], (coefficient,))]
    return replace(model, terms=tuple(terms)) if len(terms) != len(model.terms) else model


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
