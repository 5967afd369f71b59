r"""The isolation bank (3.11): a filter per combination of known effects, and which of them survive.

A filter m is excluded once its error leaves its own threshold ([Thesis] §3.5),

.. math:: |e_{m,j}| > r_j, \qquad r(t) = (I - e^{-\gamma (t - t_{dt})})\,\gamma^{-1}(\bar\eta_0 + \tilde\mu)

What this test can tell, and what not: r and all Ĉ start at zero, so a true filter leaves its threshold before it
has learned; if it is spared while it learns (`grace`), every combination that contains the true one fits as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.status import Verdict
from cdia_pin.diagnosis.thesis.basis import KnownEffects
from cdia_pin.diagnosis.thesis.sample_interval import SampleInterval
from cdia_pin.diagnosis.thesis.thesis_settings import ThesisSettings
from cdia_pin.diagnosis.thesis.threshold import TimeVaryingThreshold
from cdia_pin.diagnosis.thesis.velocity_observers import ColumnScale, VelocityObservers

Array = NDArray[np.float64]
Types = frozenset[int]


@dataclass(frozen=True)
class FilterDecision:
    """What the bank says.

    Attributes:
        verdict: Unique, ambiguous or unknown; none while it is still open.
        filters: Indices of the filters that survive, those of the fewest effects and least errors first.
    """

    verdict: Verdict
    filters: tuple[int, ...] = ()


OPEN = FilterDecision(Verdict.NONE)


def hypotheses(count: int, isolated: Types = frozenset()) -> tuple[Types, ...]:
    """Return all combinations of effects that could be there, at least one of them new.

    With v types isolated already there are 2^(N − v) − 1 ([Thesis] §3.8, whose exponent N − m counts the
    combination instead of its types).

    Args:
        count: N, types of effects known.
        isolated: Those that have been isolated, part of every combination.
    """
    fresh = [i for i in range(count) if i not in isolated]
    return tuple(
        isolated | frozenset(new) for size in range(1, len(fresh) + 1) for new in combinations(fresh, size)
    )


class FilterBank:
    """Filters that run from the detection on.

    Args:
        basis: The known effects.
        settings: Of the engine.
        unmodelled: η₀ [N·m or N], shape (n,).
        gamma: γ [1/s], shape (n,).
        known: The filter isolated before, of which every combination is a continuation.
        isolated: Its types.
    """

    def __init__(
        self,
        basis: KnownEffects,
        settings: ThesisSettings,
        unmodelled: Array,
        gamma: Array,
        known: VelocityObservers | None = None,
        isolated: Types = frozenset(),
    ) -> None:
        self.members: Sequence[Types] = hypotheses(len(basis.effects), isolated)
        used = np.array([[t in m for t in basis.of_type] for m in self.members], dtype=float)
        self.filters = VelocityObservers.fresh(basis, settings.filter_gains, gamma, used)
        if known is not None:
            self.filters.weights += known.weights
        self.alive = np.ones(len(self.members), dtype=bool)
        self.excluded_at = np.full(len(self.members), np.inf)  # [s] after detection
        self._settings = settings
        self._bound = TimeVaryingThreshold(gamma, (1.0 + settings.equivalence) * unmodelled)
        self._elapsed = 0.0
        self._misfit = np.zeros(len(self.members))

    def step(self, step: SampleInterval, scale: ColumnScale, threshold: Array) -> None:
        """Advance all filters, let them adapt beyond the detection threshold, exclude what has failed."""
        self._elapsed += step.duration
        error = np.abs(self.filters.step(step, scale))
        self.filters.adapt(step, scale, np.any(error > threshold, axis=1))
        share = error / self._bound.step(step.inverse_inertia, step.duration)
        if self._elapsed > self._settings.grace:
            failed = self.alive & (share > 1.0).any(axis=1)
            self.alive &= ~failed
            self.excluded_at[failed] = self._elapsed
            self._misfit += step.duration * (share**2).sum(axis=1)

    def decide(self) -> FilterDecision:
        """Return what can be said by now."""
        found = np.flatnonzero(self.alive)
        if not len(found):
            return FilterDecision(Verdict.UNKNOWN)
        if self._elapsed < max(self._settings.shortest_isolation, self._settings.grace):
            return OPEN
        if len(found) == 1:
            return FilterDecision(Verdict.UNIQUE, (int(found[0]),))
        if self._elapsed < self._settings.longest_isolation:
            return OPEN
        order = sorted(found.tolist(), key=lambda m: (len(self.members[m]), self._misfit[m]))
        return FilterDecision(Verdict.AMBIGUOUS, tuple(order))
