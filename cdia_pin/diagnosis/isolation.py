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

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.joint_gram import symmetric
from cdia_pin.diagnosis.kernel_cache import first_call
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.effects import Effect
from cdia_pin.regression.intervals import NORMAL_95
from cdia_pin.regression.scaled_gram import ScaledGram

Array = NDArray[np.float64]

MOST_RIVALS = 4  # combinations that a report may list beside the leading one, to stay readable
RANK_CUTOFF = 1e-15  # eigenvalues of the scaled normal equations that count as zero, over the largest
# On measured arms the right names of joints explained 0.94 and more, and a push that was taken for one 0.58. A payload
# that was none explained 0.65; it was named at a limit of 0.5.
LEAST_EXPLAINED = 0.75  # [1], share of the residual's mean square that a name must explain


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
        from cdia_pin.diagnosis import fits

        self.bank, self.lower, self.upper, self.settings = bank, lower, upper, settings
        self._ranked, self._variances = fits.ranked, fits.variances
        self._columns: dict[int, NDArray[np.int64]] = {}  # of each combination that was asked for
        count = 1 << len(bank)
        self._theta, self._score = np.zeros((count, bank.width)), np.zeros(count)
        self._order = np.zeros(count, np.int64)
        self._zero = np.zeros(bank.width)
        sizes = np.diff(bank.ends)
        self._parameters = ((np.arange(count)[:, None] >> np.arange(len(bank)) & 1) @ sizes).tolist()
        # Effects that may degenerate to a simpler one of another name; most cannot.
        self._may_degenerate = sum(
            1 << i for i, e in enumerate(bank.prototypes) if type(e).is_distinct is not Effect.is_distinct
        )
        if not fits.ranked.signatures:
            first_call("the fits of their combinations", (fits,), self._tried_once)

    def _tried_once(self) -> None:
        """Decide on nothing, in the types of a control loop."""
        gram = np.zeros((self.bank.width + 1, self.bank.width + 1))
        self.decide(0, gram, 1.0, 1.0, 1.0)
        self._variances(gram, np.zeros(1, np.int64), np.zeros(1))

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
        caused: bool = False,
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
            caused: Whether it is certain that something is there, so that no effect at all is no answer.
        """
        s, weight = self.settings, max(weight, 1.0)
        noise2 = level**2 + s.mismatch**2 * float(gram[-1, -1]) / weight
        count = self._ranked(
            gram, self.bank.ends, self.lower[j], self.upper[j], required,
            self._zero if prior is None else prior, self._zero if centre is None else centre,
            s.most_effects, weight, noise2, independent, s.tolerance**2, s.price,
            self._theta, self._score, self._order,
        )  # fmt: skip
        noise = math.sqrt(noise2)
        if not count:
            return Decision(None, self._zero.copy(), noise=noise)
        order = [m for m in self._order[:count].tolist() if m or not caused]
        if not order:
            return Decision(None, self._zero.copy(), noise=noise)
        best = next((m for m in order if self._is_distinct(m)), order[0])
        rivals = []
        for m in order[: 4 * MOST_RIVALS]:
            if self._score[m] - self._score[best] > s.lead:
                break
            # A combination that needs more parameters and gains less than their penalty is no rival.
            if m == best or self._parameters[m] > self._parameters[best] or not self._is_distinct(m):
                continue
            rivals.append((m, self._theta[m].copy()))
        return Decision(best, self._theta[best].copy(), tuple(rivals[:MOST_RIVALS]), noise)

    def intervals(self, mask: int, theta: Array, gram: Array, noise: float, independent: float) -> Array:
        """Return the 95 % interval of each parameter of a combination, shape (p, 2).

        Args:
            mask: The effects, one bit each.
            theta: Parameters of all effects of the bank, shape (P,).
            gram: Gram matrix of [y; r], upper triangle, the bank's columns first.
            noise: RMS of what is left of the residual [N·m or N].
            independent: Correlation time of a healthy residual [samples].
        """
        if mask not in self._columns:
            self._columns[mask] = self.bank.columns(self.bank.members(mask))
        columns = self._columns[mask]
        variance = np.empty(len(columns))
        if not self._variances(gram, columns, variance):  # columns that are sums of each other on this motion
            part = symmetric(gram)[np.ix_(columns, columns)]
            variance = np.maximum(np.diag(ScaledGram.of(part).pseudo_inverse(RANK_CUTOFF)), 0.0)
        half = [NORMAL_95 * noise * math.sqrt(v * independent) for v in variance.tolist()]
        found = [float(theta[k]) for k in columns]
        return np.array([(x - h, x + h) for x, h in zip(found, half, strict=True)])

    def _is_distinct(self, mask: int) -> bool:
        """Return whether no effect of a combination has degenerated to a simpler one of another name."""
        if not mask & self._may_degenerate:
            return True
        theta = self._theta[mask]
        return all(
            self.bank.prototypes[i].is_distinct(theta[self.bank.span(i)])
            for i in self.bank.members(mask & self._may_degenerate)
        )
