"""The search for the smallest set of changes that explains what differs between logs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.confidence import Confidence
from cdia_pin.changes.difference import Difference
from cdia_pin.changes.differing import Differing
from cdia_pin.regression.block_evidence import BlockEvidence, BlockFits
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.selection.discovery_settings import ChangeSettings

Array = NDArray[np.float64]

MOST_MOVES = 60  # moves of one search [1]; a guard, because no set is visited twice
LARGEST_GAINS = 40  # changes [1] of which it is asked whether they can be named; the others explain less


@dataclass(frozen=True, repr=False)
class ChangeSearch:
    """The search in the evidence of two logs.

    Attributes:
        differing: Logs before and after, and the columns of all changes.
        evidence: Normal equations without each block of time.
        settings: What a change must explain.
    """

    differing: Differing
    evidence: BlockEvidence[Difference]
    settings: ChangeSettings

    def __repr__(self) -> str:
        return f"ChangeSearch({self.evidence!r})"

    def changes(self, most: int) -> tuple[int, ...]:
        """Return the indices of the changes: they are added one by one, exchanged, and dropped.

        Args:
            most: Largest number of changes [1].
        """
        now: tuple[int, ...] = ()
        visited = {now}
        for _ in range(MOST_MOVES):
            after = next((s for s in self._moves(now) if s not in visited and len(s) <= most), None)
            if after is None:
                break
            visited.add(after)
            now = after
        return now

    def rivals(self, chosen: Sequence[int], one: int) -> list[int]:
        """Return the changes that explain as much as one of a set, the best first.

        Args:
            chosen: Indices of the set.
            one: Index of one of its members.
        """
        rest = [c for c in chosen if c != one]
        fits = self.evidence.fits(rest)
        return [c for c in self._alike(one, self._nameable(rest, fits), fits) if c != one]

    def confidence(self, rest: Sequence[int], one: int) -> Confidence:
        """Return how far the name of a change can be trusted: established if it is twice as certain as it must be.

        Blocks of time that are too short to be independent establish nothing.

        Args:
            rest: Indices of the other changes.
            one: Index of the change.
        """
        independent = self.differing.block_time >= self.settings.independent_time
        sure = self.evidence.fits(rest).certainty[one] >= 2 * self.settings.least_certainty
        return Confidence.ESTABLISHED if sure and independent else Confidence.LIKELY

    def torque(self, change: int, theta: Array) -> Array:
        """Return the RMS torque of a change in the logs after [N·m or N], shape (n,).

        Args:
            change: Index of the change.
            theta: Its parameters, shape (p,).
        """
        x = self.differing
        group = x.changes[self.evidence.effects[change]]
        return rms(group.torque(theta, x.experiment.robot.n), x.counted)

    def unseen_torque(self, chosen: Sequence[int]) -> Array:
        """Return the torque of a set in the logs after; each block of time is left out of the fit that predicts it.

        Args:
            chosen: Indices of the set.

        Returns:
            In N·m or N, shape (samples after, n).
        """
        x = self.differing
        f = np.zeros_like(x.prediction.residual)
        parts = ParameterBlocks.of([self.evidence.effects[c] for c in chosen])
        edges = zip(x.edges[:-1], x.edges[1:], strict=True)
        for theta, (start, stop) in zip(self.evidence.estimates(chosen), edges, strict=True):
            for c, own in zip(chosen, parts, strict=True):
                for j, columns in x.changes[self.evidence.effects[c]].columns.items():
                    f[start:stop, j] += columns[start:stop] @ theta[own]
        return f[x.after]

    def _moves(self, now: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
        """Yield sets that are better than a set: first simpler ones, then one with another change."""
        for one in now:
            rest = tuple(c for c in now if c != one)
            best = self._best(rest)
            if best is None:
                yield rest
            elif best[0] != one and one not in best[1]:
                yield _sorted(*rest, best[0])
        for two in combinations(now, 2):
            rest = tuple(c for c in now if c not in two)
            best = self._best(rest)
            if best is not None and best[0] not in two:
                single = _sorted(*rest, best[0])
                lost = self.evidence.unexplained(single) - self.evidence.unexplained(now)
                explained = float(np.sum(self.evidence.unexplained(rest) - self.evidence.unexplained(single)))
                if self._is_slight(lost, explained):
                    yield single
        best = self._best(now)
        if best is not None:
            yield _sorted(*now, best[0])

    def _best(self, chosen: Sequence[int]) -> tuple[int, list[int]] | None:
        """Return the change to be added to a set, and all that explain as much; None if none can be named."""
        fits = self.evidence.fits(chosen)
        nameable = self._nameable(chosen, fits)
        if not nameable:
            return None
        gain = fits.gain
        alike = self._alike(max(nameable, key=lambda c: gain[c]), nameable, fits)
        effects = self.evidence.effects

        def simplicity(c: int) -> tuple[float, float, float]:
            return (effects[c].size + len(effects[c].shape), effects[c].plausibility.penalty, -gain[c])

        return min(alike, key=simplicity), alike

    def _alike(self, one: int, others: Sequence[int], fits: BlockFits) -> list[int]:
        """Return the changes that explain as much as one, itself included, the best first."""
        alike = {c for c in others if self._is_slight(fits.gains[one] - fits.gains[c], fits.gain[one])} | {
            one
        }
        return sorted(alike, key=lambda c: -fits.gain[c])

    def _is_slight(self, lost: Array, explained: float) -> bool:
        """Return True if what is lost on the blocks, shape (B,), may be chance or does not matter."""
        spread = float(np.std(lost, ddof=1) * np.sqrt(len(lost)))
        return float(lost.sum()) < max(self.settings.alike * explained, self.settings.doubt * spread)

    def _nameable(self, chosen: Sequence[int], fits: BlockFits) -> list[int]:
        """Return the changes that can be named beside a set: sure, of some size, and explaining a visible share."""
        present = {self.evidence.effects[c].label for c in chosen}
        return [
            int(c)
            for c in np.argsort(-fits.gain)[:LARGEST_GAINS]
            if self.evidence.effects[c].label not in present and self._can_be_named(int(c), fits)
        ]

    def _can_be_named(self, change: int, fits: BlockFits) -> bool:
        gain, x = float(fits.gain[change]), self.differing
        return self.settings.is_sure(fits.certainty[change], gain) and self.settings.is_visible(
            gain, self.torque(change, fits.theta[change]), x.size, x.torque, x.samples
        )


@dataclass(frozen=True, repr=False)
class FoundChanges:
    """What a search found, with its size.

    Attributes:
        search: The search.
        chosen: Indices of the changes.
        theta: Their parameters, shape (p,).
        covariance: Covariance of the parameters, shape (p, p).
    """

    search: ChangeSearch
    chosen: tuple[int, ...]
    theta: Array
    covariance: Array

    def __repr__(self) -> str:
        return f"FoundChanges({len(self.chosen)})"

    @classmethod
    def as_searched(cls, search: ChangeSearch, chosen: tuple[int, ...]) -> Self:
        """Return changes with the sizes that they have with the columns of the search.

        Args:
            search: The search.
            chosen: Indices of the changes.
        """
        return cls(search, chosen, *search.evidence.estimate(chosen))


def _sorted(*chosen: int) -> tuple[int, ...]:
    return tuple(sorted(chosen))
