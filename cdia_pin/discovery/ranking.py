"""The ranking: what each candidate would explain by itself beside the model as given."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cdia_pin.discovery.discovery_result import Ranked
from cdia_pin.discovery.trace import step_of
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.identifiability.alternatives import Rivals
from cdia_pin.regression.fitting import Whitened, refit, with_intervals
from cdia_pin.selection.evidence import Evidence
from cdia_pin.selection.moves import ranked
from cdia_pin.selection.problem import Problem
from cdia_pin.selection.search import VISIBLE

OVERALL = 3  # candidates of any scope that are fitted, beside the best of each joint
LOOKED_AT = 40  # candidates from which these are taken


def rank(problem: Problem, model: Dynamics, whitened: Whitened) -> tuple[Ranked, ...]:
    """Fit the most telling candidates one at a time beside a model: the best overall, and the best of each joint.

    Args:
        problem: Logs and candidates.
        model: The model as given.
        whitened: Noise and blocks.

    Returns:
        The candidates that lower the held-out error of some joint, those that lower it most first.
    """
    beside = problem.beside(problem.experiment.predict(model), whitened)
    present = [i for i, e in enumerate(beside.effects) if e in {t.effect for t in model.terms}]
    before = step_of(problem, None, model, whitened)
    out = []
    for c in _shortlist(beside, ranked(beside, present, LOOKED_AT)):
        effect = beside.effects[c]
        trial, evidence = refit(
            problem.experiment, problem.columns, model.add(Term(effect, (0.0,) * effect.size)), whitened, 3
        )
        term = with_intervals(trial, evidence).find(effect.label)
        after = step_of(problem, term, trial, whitened)
        if not (after.heldout_rms < (1 - VISIBLE) * before.heldout_rms).any():
            continue
        confusions = Rivals(beside, [*present, c]).of(c)
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
    """Tell whether the best fit is physical by itself, without being held at a bound."""
    return beside.fit(chosen).chi2 <= beside.free_chi2(chosen) + 0.5 * float(beside.price[chosen[-1]])
