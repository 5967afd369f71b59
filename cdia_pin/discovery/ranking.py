"""The ranking: what each candidate would explain alone, together with the model as given."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cdia_pin.discovery.discovery_result import Ranked, Step
from cdia_pin.discovery.trace import step_of
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.identifiability.alternatives import Alternatives
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.gauss_newton import refit
from cdia_pin.regression.intervals import with_intervals
from cdia_pin.regression.shares import mean_share
from cdia_pin.robot.model import RobotModel
from cdia_pin.selection.evidence import Evidence
from cdia_pin.selection.moves import ranked
from cdia_pin.selection.problem import WhitenedProblem

OVERALL = 3  # candidates of any scope [1] that are fitted, besides the best of each joint
LOOKED_AT = 40  # candidates of largest gain [1] from which these are chosen
ITERATIONS = 3  # iterations of Gauss-Newton [1] for each of them


def rank(problem: WhitenedProblem, model: Dynamics) -> tuple[Ranked, ...]:
    """Fit candidates one at a time together with a model: the best overall, and the best of each joint.

    Args:
        problem: Logs, candidates and noise.
        model: The model as given.

    Returns:
        The candidates that lower the held-out error of some joint, by the error that they leave. Candidates that are
        physical only at a bound are left out.
    """
    beside = problem.evidence(model)
    present = [i for i, e in enumerate(beside.effects) if e in {t.effect for t in model.terms}]
    before = step_of(problem, None, model)
    possible = [c for c in ranked(beside, present, LOOKED_AT) if _is_plausible(beside, [*present, c])]
    out = []
    for c in _shortlist(beside, possible):
        effect = beside.effects[c]
        alone = model.add(Term(effect, (0.0,) * effect.size))
        trial, equations = refit(problem.regression, alone, ITERATIONS)
        term = with_intervals(trial, equations).find(effect.label)
        after = step_of(problem, term, trial)
        least_fall = problem.settings.criterion.least_fall
        falls = (after.heldout_rms < (1 - least_fall) * before.heldout_rms).any()
        if not falls or _is_at_bound(term, model.robot):
            continue
        confusions = Alternatives(beside, [*present, c], settings=problem.settings.alternatives).of(c)
        out.append(Ranked(term, before.heldout_rms, after.heldout_rms, confusions))
    torque = rms(problem.experiment.measured, problem.experiment.informative)
    return tuple(sorted(out, key=lambda r: mean_share(r.heldout_after, torque)))


def taken_first(ranking: Sequence[Ranked], steps: Sequence[Step]) -> tuple[Ranked, ...]:
    """Return a ranking that starts with the effect that a discovery added first.

    Args:
        ranking: Single candidates, each beside the model as given.
        steps: The model as given, then each effect that was added.
    """
    if not ranking or len(steps) < 2 or (first := steps[1].term) is None:
        return tuple(ranking)
    own = [r for r in ranking if r.term.label == first.label]
    errors = steps[0].heldout_rms, steps[1].heldout_rms
    taken = own[0] if own else Ranked(first, *errors, steps[1].confusions)
    return (taken, *(r for r in ranking if r is not taken))


def _shortlist(beside: Evidence, candidates: Sequence[int]) -> list[int]:
    """Return the first few candidates, and the first that acts on each joint alone."""
    of_joint: dict[int, int] = {}
    for c in candidates:
        joints = beside.effects[c].acts_on(beside.robot)
        if len(joints) == 1:
            of_joint.setdefault(joints[0], c)
    return list(dict.fromkeys([*candidates[:OVERALL], *of_joint.values()]))


def _is_plausible(beside: Evidence, chosen: Sequence[int]) -> bool:
    """Return True if the best fit is physical without a bound."""
    return beside.fit(chosen).chi2 <= beside.free_chi2(chosen) + 0.5 * float(beside.penalty[chosen[-1]])


def _is_at_bound(term: Term, robot: RobotModel) -> bool:
    """Return True if a parameter of a term sits at its bound."""
    theta = np.array(term.theta)
    return any(bool(np.isclose(theta, b, rtol=1e-6, atol=1e-12).any()) for b in term.effect.bounds(robot))
