"""Gains of drives that could not have moved the arm.

Such a gain makes the torque of its joint out of next to nothing. A body then acts on this joint many times more than on
all others, so that it imitates whatever the joint does by itself.
"""

from __future__ import annotations

from dataclasses import replace

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import ActuatorGain, Term
from cdia_pin.regression.gauss_newton import fitted_together
from cdia_pin.regression.regression import Regression

# Gain of a drive [1]. One that delivers less than a quarter of what is asked does not move an arm, and a fit with such
# a gain makes many times the torque out of next to nothing.
WEAKEST = -0.75


def is_idle(term: Term) -> bool:
    """Tell whether a term is the gain of a drive that could not have moved the arm.

    Args:
        term: A fitted term of a model.
    """
    return term.effect.name == ActuatorGain.name and min(term.theta) < WEAKEST


def has_idle_drive(model: Dynamics) -> bool:
    """Tell whether a model has the gain of a drive that could not have moved the arm.

    Args:
        model: A fitted model.
    """
    return any(map(is_idle, model.terms))


def without_idle_drives(model: Dynamics) -> Dynamics:
    """Return a model without the gains of drives that could not have moved the arm.

    Args:
        model: A fitted model.
    """
    return replace(model, terms=tuple(t for t in model.terms if not is_idle(t)))


def fitted_without_idle_drives(regression: Regression, model: Dynamics) -> Dynamics:
    """Fit all terms of a model together, without the gains of drives that could then not have moved the arm.

    Args:
        regression: The conditioned logs and their noise.
        model: The model; the iteration starts at the parameters of its terms.
    """
    model = fitted_together(regression, model)
    while has_idle_drive(model):
        model = fitted_together(regression, without_idle_drives(model))
    return model
