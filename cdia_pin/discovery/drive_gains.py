"""Drive gains that are wrong on several joints, in the place of bodies that imitate them.

A torque that is a current times a nominal constant may be wrong on any joint. A body acts on several joints at once, so
a search takes it first, and no single gain replaces it afterwards. All gains are therefore tried together.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

from cdia_pin.discovery.certain_effects import with_certain
from cdia_pin.discovery.one_by_one import heldout_error
from cdia_pin.discovery.plain_bodies import found_bodies
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import ActuatorGain, Effect
from cdia_pin.regression.gauss_newton import DIVERGED
from cdia_pin.selection.problem import WhitenedProblem
from cdia_pin.selection.search import fitted

FEWEST = 2  # gains [1]; one gain competes with a body in the search itself


def with_drive_gains(problem: WhitenedProblem, found: Dynamics, given: Dynamics) -> Dynamics | None:
    """Return a model with drive gains in the place of bodies if it predicts about as well, otherwise None.

    A search may begin there, and finds the bodies that are needed besides. Bodies of an arm that they explain wholly
    stay, for they are no coincidence.

    Args:
        problem: Logs, candidates and noise.
        found: The model that a search ended with.
        given: The model before it; its terms stay.
    """
    bodies = found_bodies(found, given)
    gains = _gains_beside(problem, found)
    if not bodies or len(gains) < FEWEST or not problem.problem.lack_of_fit(found).left.any():
        return None
    without = replace(found, terms=tuple(t for t in found.terms if t not in bodies))
    worth = problem.settings.confidence.worth_of_bodies
    with suppress(*DIVERGED):
        trial = with_certain(problem, without, gains)
        if heldout_error(problem, trial) <= worth * heldout_error(problem, found):
            return trial
    return None


def costs_less(problem: WhitenedProblem, model: Dynamics, other: Dynamics) -> bool:
    """Tell whether a model is physical and costs less than another by the criterion of the search.

    Args:
        problem: Logs, candidates and noise; it is the same for both.
        model: A fitted model.
        other: A fitted model.
    """
    then = fitted(problem, model)
    return then.fit.physical and then.cost < fitted(problem, other).cost - problem.settings.criterion.margin


def _gains_beside(problem: WhitenedProblem, model: Dynamics) -> list[Effect]:
    """Return the drive gains that a search may find and that a model lacks."""
    present = {t.label for t in model.terms}
    candidates = (f[0] for f in problem.problem.families)
    return [e for e in candidates if isinstance(e, ActuatorGain) and e.label not in present]
