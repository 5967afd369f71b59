r"""Is it one effect of the whole arm, or have joints causes of their own?

Take joint j with a healthy residual of RMS σ_j that stays alike for T_j, and normal equations over W_j seconds. An
explanation that leaves the mean square s_j of the remainder's e_j gains

.. math:: \sum_j \frac{W_j}{T_j} \frac{e_j - s_j}{2 \sigma_j^2} - c\,p

with a penalty c for each of its p parameters. An effect of the whole arm has the same parameters on all joints, those
that have stayed below their thresholds included. The joints by themselves take the best effect of each that has left
its threshold, and pay for each further joint: that it fails within the same seconds is a coincidence.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.isolation import LEAST_EXPLAINED
from cdia_pin.diagnosis.joint_gram import ridge_inverse
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.whole_arm import isolation_kernel
from cdia_pin.diagnosis.whole_arm.evidence import ArmEvidence
from cdia_pin.regression.intervals import NORMAL_95

Array = NDArray[np.float64]

LEAST_NOISE = (
    0.25  # [1], least energy left over that of one independent healthy sample: few samples say little
)
LONG_ENOUGH = 1.0  # [s] of motion, for which no push follows the formulas of effects of several joints
EXPLAINED_APART = 0.9  # [1], share of each joint's remainder that one effect must explain to rule out a push


@dataclass(frozen=True)
class ArmDecision:
    """The effect of the whole arm that explains most, beside what the joints explain by themselves.

    Attributes:
        index: Of the hypothesis; None if there is too little motion.
        theta: Its parameters, shape (shown,).
        precision: Inverse of their covariance, shape (shown, shown).
        lead: Log-likelihood by which it leads the joints' own effects and the other effects of the whole arm, penalties
            included [1].
        explained: Share of the remainder's energy that it explains [1].
        joints_explain: Whether effects of the joints explain nearly all of it for longer than a push keeps a shape.
    """

    index: int | None
    theta: Array
    precision: Array
    lead: float
    explained: float
    joints_explain: bool = False

    @property
    def half(self) -> Array:
        """Half widths of the 95 % intervals of the parameters, shape (shown,)."""
        return np.asarray(NORMAL_95 * np.sqrt(np.diag(ridge_inverse(self.precision))))

    @property
    def is_sure(self) -> bool:
        """Whether its parameters together differ from zero, and it explains most of the remainder.

        A short motion may show a weight without telling its mass from where it hangs: then the interval of each holds
        zero, and that of both together does not.
        """
        return self.index is not None and self.differs(self.theta) and self.explained >= LEAST_EXPLAINED

    def distance(self, theta: Array) -> float:
        """Return how far parameters are from zero [standard deviations].

        Args:
            theta: The parameters, shape (shown,).
        """
        return float(np.sqrt(max(float(theta @ self.precision @ theta), 0.0)))

    def differs(self, theta: Array) -> bool:
        """Tell whether the 95 % region of parameters leaves zero out.

        Args:
            theta: The parameters, shape (shown,).
        """
        return self.distance(theta) > region_95(len(theta))


@lru_cache
def region_95(size: int) -> float:
    """Return how far the 95 % region of normal parameters reaches [standard deviations].

    Args:
        size: Number of parameters.
    """
    from scipy.special import chdtri

    return float(np.sqrt(chdtri(size, 0.05)))


UNDECIDED = ArmDecision(None, np.zeros(0), np.zeros((0, 0)), -np.inf, 0.0)


def decide(
    evidence: ArmEvidence,
    bank: Bank,
    alarmed: Sequence[int],
    settings: MonitorSettings,
    only: int | None = None,
) -> ArmDecision:
    """Decide from the present normal equations.

    Args:
        evidence: The normal equations.
        bank: Known effects of the joints.
        alarmed: Joints that have left their thresholds.
        settings: Penalty of a parameter.
        only: Index of the one hypothesis that is fitted; all of them if omitted.
    """
    has_alarmed = np.zeros(len(evidence.weight), bool)
    has_alarmed[list(alarmed)] = True
    size = len(evidence.prior)
    theta, precision = np.empty(size), np.empty((size, size))
    best, lead, explained, left, share = isolation_kernel.decided(
        evidence.gram, evidence.weight, evidence.level, evidence.independent, has_alarmed, bank.ends,
        evidence.ends, evidence.prior, evidence.unusual, settings.price, -1 if only is None else only,
        theta, precision,
    )  # fmt: skip
    if best < 0:
        return UNDECIDED
    first, end = (int(e) - evidence.width for e in evidence.ends[best : best + 2])
    # Precision and misfit both grow with the samples. So the interval is as wide as that of one independent sample:
    # what a model lacks does not average out over postures.
    inverse = precision[first:end, first:end] / max(LEAST_NOISE, left)
    seen = bool(alarmed) and float(evidence.weight[has_alarmed].min()) >= LONG_ENOUGH
    apart = seen and share >= EXPLAINED_APART
    return ArmDecision(best, theta[first:end].copy(), inverse, lead, explained, apart)
