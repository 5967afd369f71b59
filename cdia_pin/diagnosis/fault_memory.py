"""Cleared faults of one joint: they are recognised at once when they return."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.belief import JointBelief
from cdia_pin.diagnosis.joint_gram import gram_parts
from cdia_pin.diagnosis.stateful import Stateful

Array = NDArray[np.float64]

LOOKS_NEEDED = 3  # looks in a row that a remembered fault must explain before it is believed again
LARGEST_REST = 0.05  # [1], share of the residual's energy that it may leave unexplained


class FaultMemory(Stateful):
    """Beliefs that were once right, and how many looks in a row one of them has explained the residual."""

    STATE = ("_all", "_looks")

    def __init__(self) -> None:
        self._all: list[JointBelief] = []
        self._looks = 0

    def __iter__(self) -> Iterator[JointBelief]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    def add(self, cleared: JointBelief) -> None:
        """Remember a cleared fault.

        Args:
            cleared: The fault with its last parameters; it replaces an older one of the same effects.
        """
        self._all = [m for m in self._all if m.mask != cleared.mask] + [cleared]

    def forget(self, mask: int) -> None:
        """Forget all faults with any of these effects, because they are present again.

        Args:
            mask: The effects, one bit each.
        """
        self._all = [m for m in self._all if m.mask & mask == 0]

    def begin(self) -> None:
        """Count the looks from zero."""
        self._looks = 0

    def recall(self, belief: JointBelief, gram: Array) -> JointBelief | None:
        """Return the fault that, together with a belief, has explained the residual for enough looks, or None.

        Args:
            belief: What is believed already.
            gram: Gram matrix of [y; r], upper triangle, the bank's columns first.
        """
        if not self._all:
            self._looks = 0
            return None
        parts = gram_parts(gram, len(belief.theta))
        for memory in self._all:
            if parts.left(belief.theta + memory.theta) < LARGEST_REST * parts.energy:
                self._looks += 1
                return memory if self._looks >= LOOKS_NEEDED else None
        self._looks = 0
        return None
