"""The ranking: what each candidate would explain alone, together with the model as given."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cdia_pin.discovery.discovery_result import Ranked
from cdia_pin.discovery.trace import step_of
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.identifiability.alternatives import Alternatives
from cdia_pin.regression.gauss_newton import refit
from cdia_pin.regression.intervals import with_intervals
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
        The candidates that lower the held-out error of some joint; the one that lowers it most comes first.
    """
    beside = problem.evidence(model)
    present = [i for i, e in enumerate(beside.effects) if e in {t.effect for t in model.terms}]
    before = step_of(problem, None, model)
    out = []
    for c in _shortlist(beside, ranked(beside, present, LOOKED_AT)):
        effect = beside.effects[c]
        alone = model.add(Term(effect, (0.0,) * effect.size))
        trial, equations = refit(problem.regression, alone, ITERATIONS)
        term = with_intervals(trial, equations).find(effect.label)
        after = step_of(problem, term, trial)
        least_fall = problem.settings.criterion.least_fall
        if not (after.heldout_rms < (1 - least_fall) * before.heldout_rms).any():
            continue
        confusions = Alternatives(beside, [*present, c], settings=problem.settings.alternatives).of(c)
        out.append(
            Ranked(term, before.heldout_rms, after.heldout_rms, _plausible(beside, [*present, c]), confusions)
        )
    relative = lambda r: float(np.mean(r.heldout_after / np.maximum(r.heldout_before, 1e-12)))  # noqa: E731
    return tuple(sorted(out, key=relative))


def _shortlist(beside: Evidence, candidates: Sequence[int]) -> list[int]:
    """Return the first few candidates, and the first that acts on each joint alone."""
    of_joint: dict[int, int] = {}
    for c in candidates:
        joints = beside.effects[c].acts_on(beside.robot)
        if len(joints) == 1:
            of_joint.setdefault(joints[0], c)
    return list(dict.fromkeys([*candidates[:OVERALL], *of_joint.values()]))


def _plausible(beside: Evidence, chosen: Sequence[int]) -> bool:
    """Return True if the best fit is physical without a bound."""
    return beside.fit(chosen).chi2 <= beside.free_chi2(chosen) + 0.5 * float(beside.penalty[chosen[-1]])
