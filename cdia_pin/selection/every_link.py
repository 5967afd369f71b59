"""Every link slightly wrong: many small errors of a URDF, which no single body explains.

Each error is too small to be named, so the search does not find it link by link. A payload or one wrong link can
imitate all of them on this motion, but is wrong on another one. All links are therefore tried at once, as one effect.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import LinkInertia, LinkInertias, Term
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.gauss_newton import refit
from cdia_pin.robot.model import RobotModel
from cdia_pin.selection.problem import WhitenedProblem
from cdia_pin.selection.search import fitted


def with_every_link(problem: WhitenedProblem, found: Dynamics) -> Dynamics | None:
    """Return a better model in which every link may be slightly wrong, or None.

    It must cost less and predict held-out blocks of time visibly better. It need not have the torque that other effects
    need, because it may have more on another motion. Bodies that were found are dropped if they are no longer needed.

    Args:
        problem: Logs, candidates and noise.
        found: The model that a search ended with.
    """
    links = possible_links(found.robot)
    if links is None or not problem.settings.may_find([LinkInertias.name]) or has_every_link(found):
        return None
    settings = problem.settings.every_link
    effects = [t.effect for t in found.terms]
    before = problem.regression.normal_equations(found, effects)
    unseen = before.held_out(range(len(effects)), found.theta)
    for bare in _without_bodies(found):
        trial = bare.add(Term(links, (0.0,) * links.size))
        trial, after = refit(problem.regression, trial)
        gain = unseen - after.held_out(range(len(trial.terms)), trial.theta)
        if (
            gain > settings.least_fall * unseen
            and _is_slight(trial, settings.largest_error)
            and _is_better(problem, found, trial, gain)
        ):
            return trial
    return None


def has_every_link(model: Dynamics) -> bool:
    """Return True if every link may differ in a model.

    Args:
        model: The model.
    """
    return any(isinstance(t.effect, LinkInertias) for t in model.terms)


def possible_links(robot: RobotModel) -> LinkInertias | None:
    """Return the links that are possible bodies as the URDF has them; None for fewer than two.

    Another link is more than slightly wrong.

    Args:
        robot: The arm.
    """
    possible = [j for j in robot.joints if LinkInertia(j).is_physical(np.zeros(LinkInertia(j).size), robot)]
    return LinkInertias(tuple(possible)) if len(possible) > 1 else None


def _without_bodies(model: Dynamics) -> Iterator[Dynamics]:
    """Yield the model without its bodies, without its wrong links, and as it is."""
    chosen = (
        tuple(t for t in model.terms if not t.effect.bodies),
        tuple(t for t in model.terms if not isinstance(t.effect, LinkInertia)),
        model.terms,
    )
    yield from (Dynamics(model.robot, terms) for terms in dict.fromkeys(chosen))


def _is_slight(model: Dynamics, largest: float) -> bool:
    """Return True if the links of a model differ by no more than is usual."""
    term = next(t for t in model.terms if isinstance(t.effect, LinkInertias))
    usual = term.effect.prior_scale(model.robot)
    return bool(np.sqrt(np.mean((np.array(term.theta) / usual) ** 2)) <= largest)


def _is_better(problem: WhitenedProblem, now: Dynamics, then: Dynamics, gain: float) -> bool:
    """Return True if a model costs less than another, and held-out blocks confirm the gain."""
    before, after = (fitted(problem, model) for model in (now, then))
    cheaper = before.cost - after.cost
    experiment = problem.experiment
    fallen = np.sqrt(np.maximum(before.errors**2 - after.errors**2, 0.0))
    torque = rms(experiment.measured, experiment.informative)
    settings = problem.settings
    least = np.maximum(
        settings.lack_of_fit.least_torque * torque, settings.every_link.over_blur * experiment.blur
    )
    matters = bool((fallen > least).any())
    criterion = problem.settings.criterion
    proven = cheaper > criterion.margin and gain > criterion.heldout_share * cheaper
    return after.fit.physical and matters and proven
