r"""Isolation: which combination of known effects explains a joint's residual, from its normal equations.

Every one of the 2^N − 1 combinations is fitted. Take a healthy residual of RMS σ with the correlation time T, and a
combination m that leaves the mean square s_m over a window W. Its score is

.. math:: J_m = \frac{W}{T} \frac{s_m}{2 \sigma^2} + c\,(p_m + k_m - 1)

the negative log-likelihood, with a penalty c for each of its p_m parameters and for each of its k_m effects after the
first. A combination is *possible* if its parameters are physical and it leaves no more than a healthy residual, with a
tolerance. The possible combination of least score is the answer. If its lead is too small, the answer is ambiguous;
if no combination is possible, the fault is unknown.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.joint_gram import first_columns, symmetric
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.regression.scaled_gram import ScaledGram

Array = NDArray[np.float64]

MOST_RIVALS = 4  # combinations that a report may list beside the leading one, to stay readable
RANK_CUTOFF = 1e-15  # eigenvalues of the scaled normal equations that count as zero, over the largest
NORMAL_95 = 1.96  # [1], standard deviations to either side of a 95 % interval


@dataclass(frozen=True)
class Decision:
    """Result of one look at the normal equations of a joint.

    Attributes:
        mask: Effects of the leading combination, one bit each; None if no combination is possible.
        theta: Its parameters, zero for the other effects, shape (P,).
        rivals: Other combinations that explain the residual equally well, best first.
        noise: RMS that the residual is allowed to keep [N·m or N].
    """

    mask: int | None
    theta: Array
    rivals: tuple[tuple[int, Array], ...] = ()
    noise: float = 0.0

    @property
    def key(self) -> int:
        """Number that votes compare: the mask, or −1 for an unknown fault."""
        return -1 if self.mask is None else self.mask


class Isolator:
    """Decides between the combinations of a bank.

    Args:
        bank: The known effects.
        lower: Smallest parameters on each joint, shape (n, P).
        upper: Largest parameters on each joint, shape (n, P).
        settings: Tolerance, penalty and lead.
    """

    def __init__(self, bank: Bank, lower: Array, upper: Array, settings: MonitorSettings) -> None:
        from cdia_pin.diagnosis.fits import subsets

        self.bank, self.lower, self.upper, self.settings = bank, lower, upper, settings
        self._subsets = subsets
        count = 1 << len(bank)
        self._theta = np.zeros((count, bank.width))
        self._rss, self._ok = np.zeros(count), np.zeros(count, bool)
        masks = np.arange(count)
        sizes = np.diff(bank.ends)
        members = masks[:, None] >> np.arange(len(bank)) & 1  # (2^N, N)
        self._parameters = members @ sizes
        self._further = np.maximum(members.sum(axis=1) - 1, 0)  # several changes at once are rarer than one

    def decide(
        self,
        j: int,
        gram: Array,
        weight: float,
        level: float,
        independent: float,
        required: int = 0,
        prior: Array | None = None,
        centre: Array | None = None,
    ) -> Decision:
        """Decide on a joint.

        Args:
            j: The joint's index.
            gram: Gram matrix of [y; r], upper triangle, the bank's columns first, the residual last, shape
                (P + 1, P + 1) or larger.
            weight: Number of samples in it, old ones discounted [1].
            level: RMS of a healthy residual [N·m or N].
            independent: Correlation time of a healthy residual [samples].
            required: Effects that every combination contains, one bit each.
            prior: Precision of the parameters that are believed already, shape (P,); none if omitted.
            centre: Parameters that are believed already, shape (P,).
        """
        P, s, weight = self.bank.width, self.settings, max(weight, 1.0)
        zero = np.zeros(P)
        own = first_columns(gram, P)
        self._theta[:] = 0.0
        self._subsets(
            own, self.bank.ends, self.lower[j], self.upper[j], required,
            zero if prior is None else prior, zero if centre is None else centre,
            s.most_effects, self._theta, self._rss, self._ok,
        )  # fmt: skip
        noise2 = level**2 + s.mismatch**2 * own[-1, -1] / weight
        possible = self._ok & (self._rss / weight <= s.tolerance**2 * noise2)
        if not possible.any():
            return Decision(None, zero, noise=float(np.sqrt(noise2)))
        score = 0.5 * self._rss / noise2 / independent + s.price * (self._parameters + self._further)
        score[~possible] = np.inf
        order = np.argsort(score, kind="stable")
        best = self._first_distinct(order, score)
        rivals = []
        for m in order[: 4 * MOST_RIVALS]:
            if m == best or score[m] - score[best] > s.lead:
                continue
            # A combination that needs more parameters and gains less than their penalty is no rival.
            if self._parameters[m] > self._parameters[best] or not self._is_distinct(int(m)):
                continue
            rivals.append((int(m), self._theta[m].copy()))
        return Decision(
            int(best), self._theta[best].copy(), tuple(rivals[:MOST_RIVALS]), float(np.sqrt(noise2))
        )

    def intervals(self, mask: int, theta: Array, gram: Array, noise: float, independent: float) -> Array:
        """Return the 95 % interval of each parameter of a combination, shape (p, 2).

        Args:
            mask: The effects, one bit each.
            theta: Parameters of all effects of the bank, shape (P,).
            gram: Gram matrix of [y; r], upper triangle, the bank's columns first.
            noise: RMS of what is left of the residual [N·m or N].
            independent: Correlation time of a healthy residual [samples].
        """
        columns = self.bank.columns(self.bank.members(mask))
        part = symmetric(gram)[np.ix_(columns, columns)]
        variance = np.diag(ScaledGram.of(part).pseudo_inverse(RANK_CUTOFF))
        half = NORMAL_95 * noise * np.sqrt(np.maximum(variance, 0.0) * independent)
        return np.column_stack([theta[columns] - half, theta[columns] + half])

    def _first_distinct(self, order: NDArray[np.int64], score: Array) -> int:
        for m in order:
            if not np.isfinite(score[m]):
                break
            if self._is_distinct(int(m)):
                return int(m)
        return int(order[0])

    def _is_distinct(self, mask: int) -> bool:
        """Return whether no effect of a combination has degenerated to a simpler one of another name."""
        theta = self._theta[mask]
        return all(
            self.bank.prototypes[i].is_distinct(theta[self.bank.span(i)]) for i in self.bank.members(mask)
        )
