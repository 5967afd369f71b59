r"""Which combination of known effects explains a joint's residual, from its normal equations.

Every one of the 2^N − 1 combinations is fitted. Against a healthy residual of RMS σ that forgets itself within
the time T, a combination m that leaves the mean square s_m over a window W has the log-likelihood
−(W / T) s_m / (2 σ²); each of its parameters has a price. A combination is *possible* if its parameters are, and
if it leaves no more than a healthy residual, with a tolerance. The one that leads all other possible ones is the
answer; if it does not lead by enough, the answer is ambiguous; if none is possible, the fault is unknown.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.settings import MonitorSettings

Array = NDArray[np.float64]

MOST_RIVALS = 4  # that are reported


@dataclass(frozen=True)
class Decision:
    """What one look at the normal equations of a joint says.

    Attributes:
        mask: Effects of the leading combination, one bit each; None if no combination is possible.
        theta: Its parameters, zero for the others, shape (P,).
        rivals: Other combinations that explain the same, best first.
        noise: RMS that the residual is allowed [N·m or N].
    """

    mask: int | None
    theta: Array
    rivals: tuple[tuple[int, Array], ...] = ()
    noise: float = 0.0

    @property
    def key(self) -> int:
        """What votes compare; −1 stands for unknown."""
        return -1 if self.mask is None else self.mask


class Isolator:
    """Decide between the combinations of a bank.

    Args:
        bank: The known effects.
        lower: Smallest parameters on each joint, shape (n, P).
        upper: Largest parameters on each joint, shape (n, P).
        settings: Tolerance, price and lead.
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
            j: The joint.
            gram: Gram matrix of [y; r], upper triangle, the bank's columns first, the residual last.
            weight: Number of samples in it.
            level: RMS of a healthy residual [N·m or N].
            independent: Samples after which a healthy residual has forgotten itself.
            required: Effects that are there already.
            prior: Weight of what is believed of their parameters, shape (P,).
            centre: What is believed of them, shape (P,).
        """
        P, s, weight = self.bank.width, self.settings, max(weight, 1.0)
        zero = np.zeros(P)
        own = np.empty((P + 1, P + 1))
        own[:P, :P], own[:P, P], own[P, P] = gram[:P, :P], gram[:P, -1], gram[-1, -1]
        self._theta[:] = 0.0
        self._subsets(
            own, self.bank.ends, self.lower[j], self.upper[j], required,
            zero if prior is None else prior, zero if centre is None else centre,
            s.most_effects, self._theta, self._rss, self._ok,
        )  # fmt: skip
        noise2 = level**2 + s.mismatch**2 * own[P, P] / weight
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
            # what needs more parameters and gains less than their price is no rival
            if self._parameters[m] > self._parameters[best] or not self._is_distinct(int(m)):
                continue
            rivals.append((int(m), self._theta[m].copy()))
        return Decision(
            int(best), self._theta[best].copy(), tuple(rivals[:MOST_RIVALS]), float(np.sqrt(noise2))
        )

    def intervals(self, mask: int, theta: Array, gram: Array, noise: float, independent: float) -> Array:
        """Return the 95 % interval of each parameter of a combination, shape (p, 2)."""
        columns = self.bank.columns(self.bank.members(mask))
        part = symmetric(gram)[np.ix_(columns, columns)]
        unit = 1.0 / np.sqrt(np.maximum(np.diag(part), 1e-300))
        inverse = np.linalg.pinv(part * np.outer(unit, unit), hermitian=True)
        half = 1.96 * noise * unit * np.sqrt(np.maximum(np.diag(inverse), 0.0) * independent)
        return np.column_stack([theta[columns] - half, theta[columns] + half])

    def _first_distinct(self, order: NDArray[np.int64], score: Array) -> int:
        for m in order:
            if not np.isfinite(score[m]):
                break
            if self._is_distinct(int(m)):
                return int(m)
        return int(order[0])

    def _is_distinct(self, mask: int) -> bool:
        """Tell whether every effect of a combination is more than a simpler one with another name."""
        theta = self._theta[mask]
        return all(
            self.bank.prototypes[i].is_distinct(theta[self.bank.span(i)]) for i in self.bank.members(mask)
        )


def symmetric(gram: Array) -> Array:
    """Return a matrix of which only the upper triangle is kept, shape (p, p)."""
    upper = np.triu(gram)
    return np.asarray(upper + np.triu(upper, 1).T)
