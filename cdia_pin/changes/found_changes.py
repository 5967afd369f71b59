"""What a search for changes found, with its size."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.change_search import ChangeSearch
from cdia_pin.changes.difference import Difference

Array = NDArray[np.float64]


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

    @property
    def effects(self) -> list[Difference]:
        """The changes."""
        return [self.search.evidence.effects[c] for c in self.chosen]

    @property
    def left(self) -> Array:
        """What is left of each block of time when that block is left out [1], shape (B,)."""
        return self.search.evidence.unexplained(self.chosen)

    def leaves_less(self, other: Self) -> bool:
        """Tell whether these changes leave less of the same logs than others, by more than chance.

        Args:
            other: The other changes, in the same units of what is left.
        """
        explained = float(np.sum(self.search.evidence.unexplained(()) - self.left))
        return not self.search.is_slight(other.left - self.left, explained)
