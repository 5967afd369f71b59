"""Faults of one joint that were there and are gone: known again at once when they return."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.belief import Belief
from cdia_pin.diagnosis.isolation import symmetric

Array = NDArray[np.float64]

LOOKS = 3  # that a remembered fault must explain to be taken up again
LEFT = 0.05  # [1], share of the residual's energy that it may leave


class Memories:
    """Beliefs that were once right, and how often in a row one of them explained what is seen now."""

    def __init__(self) -> None:
        self._all: list[Belief] = []
        self._looks = 0

    def __iter__(self) -> Iterator[Belief]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    def add(self, gone: Belief) -> None:
        """Remember a fault that is gone, with its last size."""
        self._all = [m for m in self._all if m.mask != gone.mask] + [gone]

    def forget(self, mask: int) -> None:
        """Forget what has any of these effects: it is there."""
        self._all = [m for m in self._all if m.mask & mask == 0]

    def begin(self) -> None:
        """Begin to look anew."""
        self._looks = 0

    def recall(self, belief: Belief, gram: Array) -> Belief | None:
        """Return the fault that with what is believed has explained what was seen for some looks, or None.

        Args:
            belief: What is believed already.
            gram: Gram matrix of [y; r], upper triangle.
        """
        P = len(belief.theta)
        full, energy = symmetric(gram[:P, :P]), gram[-1, -1]
        for memory in self._all:
            theta = belief.theta + memory.theta
            rss = energy - 2 * theta @ gram[:P, -1] + theta @ full @ theta
            if rss < LEFT * energy:
                self._looks += 1
                return memory if self._looks >= LOOKS else None
        self._looks = 0
        return None
