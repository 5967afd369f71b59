"""A belief about one joint: which effects are present, and how large they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.status import Verdict

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class JointBelief:
    """A combination of effects of a bank with their parameters, or none.

    Attributes:
        theta: Parameters of all effects of the bank, zero for those not believed in, shape (P,).
        mask: The effects, one bit each.
        verdict: Result of isolation; without effects ``unknown`` or ``none``.
        ci95: 95 % intervals of the believed effects' parameters, shape (p, 2); None where they are not known.
        rivals: Other combinations that explain the residual equally well, each with parameters of shape (P,).
    """

    theta: Array
    mask: int = 0
    verdict: Verdict = Verdict.NONE
    ci95: Array | None = None
    rivals: tuple[tuple[int, Array], ...] = ()

    @classmethod
    def nothing(cls, bank: Bank, verdict: Verdict = Verdict.NONE) -> JointBelief:
        """Return the belief in no effect of a bank.

        Args:
            bank: The known effects.
            verdict: ``unknown`` if there is a fault nevertheless.
        """
        return cls(np.zeros(bank.width), verdict=verdict)

    def is_certain(self, bank: Bank) -> bool:
        """Tell whether every believed effect has a parameter whose interval does not hold zero.

        Args:
            bank: The known effects.
        """
        if self.ci95 is None:
            return True
        differs: NDArray[np.bool_] = np.prod(self.ci95, axis=1) > 0.0
        ends = np.cumsum([0, *(bank.prototypes[i].size for i in bank.members(self.mask))])
        return all(bool(differs[a:b].any()) for a, b in pairwise(ends))

    def parted(self, bank: Bank, effects: Sequence[int]) -> tuple[JointBelief, JointBelief]:
        """Return the belief in some of its effects, and the belief in the others.

        Args:
            bank: The known effects.
            effects: Indices of the first part.
        """
        mask = sum(1 << i for i in effects)
        within = np.isin(np.arange(len(self.theta)), bank.columns(effects))
        part = JointBelief(np.where(within, self.theta, 0.0), mask)
        rest = JointBelief(np.where(within, 0.0, self.theta), self.mask & ~mask, self.verdict)
        return part, rest

    def joined(self, other: JointBelief) -> JointBelief:
        """Return the belief in the effects of both.

        Args:
            other: A belief in other effects of the same bank.
        """
        return replace(
            self, theta=self.theta + other.theta, mask=self.mask | other.mask, ci95=None, rivals=()
        )
