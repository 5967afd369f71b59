r"""The isolation bank (3.11): one filter for each combination of known effects, and those that survive.

A filter m is excluded as soon as its error leaves its own threshold ([Thesis] §3.5),

.. math:: |e_{m,j}| > r_j, \qquad r(t) = (I - e^{-\gamma (t - t_{dt})})\,\gamma^{-1}(\bar\eta_0 + \tilde\mu)

The test has a limit: r and all Ĉ start at zero, so the true filter leaves its threshold before it has learned. If it
is spared while it learns (`grace`), every combination that contains the true one fits as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.stateful import Stateful
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
    """Decision of the bank.

    Attributes:
        verdict: Unique, ambiguous or unknown; none while isolation is open.
        filters: Indices of the surviving filters, by number of effects, then by error.
    """

    verdict: Verdict
    filters: tuple[int, ...] = ()

    @property
    def is_open(self) -> bool:
        """Whether there is no decision yet."""
        return self.verdict is Verdict.NONE


OPEN = FilterDecision(Verdict.NONE)


def hypotheses(count: int, isolated: Types = frozenset()) -> tuple[Types, ...]:
    """Return all combinations of effects that may be present, with at least one new effect.

    With v types isolated already there are 2^(N − v) − 1. The exponent of [Thesis] §3.8, N − m, counts combinations.

    Args:
        count: N, number of known effects.
        isolated: Indices of the effects that are isolated already; every combination contains them.
    """
    fresh = [i for i in range(count) if i not in isolated]
    return tuple(
        isolated | frozenset(new) for size in range(1, len(fresh) + 1) for new in combinations(fresh, size)
    )


class FilterBank(Stateful):
    """Filters that run from the detection on.

    Args:
        basis: The known effects.
        settings: Settings of the engine.
        unmodelled: η₀ [N·m or N], shape (n,).
        gamma: γ [1/s], shape (n,).
        known: The filter of the isolated effects, whose parameters every combination takes over.
        isolated: Indices of its effects.
    """

    STATE = ("members", "filters", "alive", "excluded_at", "_bound", "_elapsed", "_misfit")

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
        """Advance all filters, let them adapt beyond the detection threshold, and exclude those that failed.

        Args:
            step: The interval.
            scale: Columns of the interval.
            threshold: Detection threshold [rad/s or m/s], shape (n,).
        """
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
        """Return the decision by now."""
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
