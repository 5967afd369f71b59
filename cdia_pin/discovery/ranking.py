"""The ranking: what each candidate would explain by itself beside the model as given."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cdia_pin.discovery.confusion import find_confusions
from cdia_pin.discovery.evidence import Evidence
from cdia_pin.discovery.fitting import Whitened, refit, with_intervals
from cdia_pin.discovery.moves import ranked
from cdia_pin.discovery.problem import Problem
from cdia_pin.discovery.result import Ranked
from cdia_pin.discovery.trace import step_of
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term

SHOWN = 6


def rank(problem: Problem, model: Dynamics, whitened: Whitened, count: int = SHOWN) -> tuple[Ranked, ...]:
    """Fit the most telling candidates one at a time beside a model.

    Args:
        problem: Logs and candidates.
        model: The model as given.
        whitened: Noise and blocks.
        count: How many to fit.

    Returns:
        The candidates, the one that explains most first.
    """
    beside = problem.beside(problem.experiment.predict(model), whitened)
    present = [i for i, e in enumerate(beside.effects) if e in {t.effect for t in model.terms}]
    before = step_of(problem, None, model, whitened)
    out = []
    for c in ranked(beside, present, count):
        effect = beside.effects[c]
        trial, evidence = refit(
            problem.experiment, problem.columns, model.add(Term(effect, (0.0,) * effect.size)), whitened, 3
        )
        term = with_intervals(trial, evidence).find(effect.label)
        after = step_of(problem, term, trial, whitened)
        confusions = find_confusions(beside, [*present, c], c)
        out.append(
            Ranked(term, before.heldout_rms, after.heldout_rms, _plausible(beside, [*present, c]), confusions)
        )
    relative = lambda r: float(np.mean(r.heldout_after / np.maximum(r.heldout_before, 1e-12)))  # noqa: E731
    return tuple(sorted(out, key=relative))


def _plausible(beside: Evidence, chosen: Sequence[int]) -> bool:
    """Tell whether the best fit is physical by itself, without being held at a bound."""
    return beside.fit(chosen).chi2 <= beside.free_chi2(chosen) + 0.5 * float(beside.price[chosen[-1]])
