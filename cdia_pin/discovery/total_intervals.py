"""Total intervals: the statistical part of a fit and the systematic part of repeated decisions together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from cdia_pin.discovery.trust import Trust
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term


def with_total_intervals(model: Dynamics, trust: Mapping[str, Trust]) -> Dynamics:
    """Return a model whose 95 % intervals hold the statistical and the systematic part.

    Args:
        model: A model with statistical intervals.
        trust: What the repeats say about its effects, by label.
    """

    def widened(term: Term) -> Term:
        if term.label not in trust or term.ci95 is None:
            return term
        statistical, known = term.half_widths, trust[term.label]
        shown = np.maximum(statistical, known.of_speeds)
        return term.with_intervals(np.hypot(shown, known.systematic), statistical)

    return replace(model, terms=tuple(map(widened, model.terms)))
