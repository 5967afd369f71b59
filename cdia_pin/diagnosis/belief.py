"""A belief about one joint: which effects are there, and how large."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.status import Verdict

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Belief:
    """A combination of effects of a bank with its sizes, or none.

    Attributes:
        theta: Parameters of all effects of the bank, zero where an effect is not believed in, shape (P,).
        mask: The effects, one bit each.
        verdict: What isolation says; without effects ``unknown`` or ``none``.
        ci95: Intervals of the parameters of the effects, shape (p, 2), where they are known.
        rivals: Other combinations that explain the same, each with parameters of shape (P,).
    """

    theta: Array
    mask: int = 0
    verdict: Verdict = Verdict.NONE
    ci95: Array | None = None
    rivals: tuple[tuple[int, Array], ...] = ()

    @classmethod
    def nothing(cls, bank: Bank, verdict: Verdict = Verdict.NONE) -> Belief:
        """Return the belief in no effect of a bank."""
        return cls(np.zeros(bank.width), verdict=verdict)

    def parted(self, bank: Bank, effects: Sequence[int]) -> tuple[Belief, Belief]:
        """Return the belief in some of its effects, and the one in all others."""
        mask = sum(1 << i for i in effects)
        within = np.isin(np.arange(len(self.theta)), bank.columns(effects))
        part = Belief(np.where(within, self.theta, 0.0), mask)
        rest = Belief(np.where(within, 0.0, self.theta), self.mask & ~mask, self.verdict)
        return part, rest

    def joined(self, other: Belief) -> Belief:
        """Return the belief in the effects of both."""
        return replace(
            self, theta=self.theta + other.theta, mask=self.mask | other.mask, ci95=None, rivals=()
        )
