r"""The second detector: what is too small for a threshold, but lasts.

A threshold answers the largest value of a residual. On measured arms that value is large, because a model is wrong at
reversals and in some postures, and a fault may stay below it for good. This detector asks instead how much torque one
known effect explains over some seconds,

.. math:: g_h = \sqrt{\Sigma r\,y_h^T\,(\Sigma\,y_h y_h^T)^{-1}\,\Sigma\,y_h r \,/\, K}

It is the generalised likelihood ratio of the effect h in a window [Basseville1993], in units of torque. Its limit is
the largest value of healthy runs, raised for the time that the user wants between two false alarms: the largest of N
windows of a Gaussian process grows with √ln N.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis import kernels, lasting_kernel, ridge_kernel
from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.kernel_cache import first_call
from cdia_pin.diagnosis.lasting_kernel import LEAST_SHARE
from cdia_pin.diagnosis.stateful import Stateful

Array = NDArray[np.float64]

LEAST_WINDOWS = (
    2.0  # [1], number of windows that healthy runs count as at least: its logarithm must be positive
)
FILLED = 0.5  # [1], share of the window that must hold motion before it counts


class LastingDetector(Stateful):
    """How much torque each effect of the bank explains of late, on each joint.

    Args:
        bank: The known effects.
        n: Number of joints.
        memory: Time after which a sample counts 1/e [s].

    Attributes:
        limit: Explained torque of a healthy arm [N·m or N], shape (n, N); infinite until it is learned.
        weight: Duration of the motion seen, old samples discounted [s], shape (n,).
    """

    STATE = ("_gram", "_energy", "weight")

    def __init__(self, bank: Bank, n: int, memory: float) -> None:
        self._ends, self._memory = bank.ends, memory
        self._gram = np.zeros((n, bank.width + 1, bank.width + 1))  # upper triangles
        self._energy = np.zeros(n)  # integral of the squared torque [(N·m)² s or N² s]
        self.weight = np.zeros(n)
        self.limit = np.full((n, len(bank)), np.inf)
        if not lasting_kernel.beyond.signatures:
            first_call(
                "the detector of what lasts", (lasting_kernel, ridge_kernel, kernels), self._tried_once
            )

    def _tried_once(self) -> None:
        """Take a sample in the types of a control loop, and forget it."""
        none, columns = np.zeros(len(self.weight)), np.zeros((len(self.weight), int(self._ends[-1])))
        self.add(0.0, columns, none, none, none)
        self.beyond(none)

    def reset(self, joints: Sequence[int] | None = None) -> None:
        """Forget what was seen.

        Args:
            joints: Of these joints only; of all if omitted.
        """
        which = slice(None) if joints is None else list(joints)
        self._gram[which], self._energy[which], self.weight[which] = 0.0, 0.0, 0.0

    def add(
        self, dt: float, columns: Array, remainder: Array, torque: Array, counts: Array | NDArray[np.bool_]
    ) -> None:
        """Add a sample.

        Args:
            dt: Time since the last one [s].
            columns: Filtered columns of the effects, shape (n, P) or wider.
            remainder: Residual less the torque of what is believed [N·m or N], shape (n,).
            torque: Measured torque [N·m or N], shape (n,).
            counts: Which joints move, 1 or 0, shape (n,).
        """
        keep = exp(-dt / self._memory)
        lasting_kernel.add(
            self._gram, self._energy, self.weight, columns, remainder, torque, counts, dt, keep
        )

    def explained(self) -> Array:
        """Return the RMS torque that each effect explains [N·m or N], zero without enough motion, shape (n, N)."""
        found: Array = lasting_kernel.explained(self._gram, self.weight, self._ends, FILLED * self._memory)
        return found

    def beyond(self, believed: Array) -> NDArray[np.bool_]:
        """Return the joints on which an effect explains more than a healthy arm shows, shape (n,).

        Args:
            believed: Largest torque of late of what is believed [N·m or N], shape (n,). Its formula may miss a share.
        """
        found: NDArray[np.bool_] = lasting_kernel.beyond(
            self.explained(), self.limit, self._energy, self.weight, believed
        )
        return found


def limit_of(largest: Array, moved: Array, memory: float, false_alarm_every: float, torque: Array) -> Array:
    """Return the limit of the explained torque [N·m or N], shape (n, N).

    Args:
        largest: Largest explained torque of healthy runs [N·m or N], shape (n, N).
        moved: How long each joint moved in them [s], shape (n,).
        memory: Time after which a sample counts 1/e [s].
        false_alarm_every: Mean time between false alarms that the user accepts [s].
        torque: RMS torque of the healthy runs [N·m or N], shape (n,).
    """
    seen = np.maximum(moved / memory, LEAST_WINDOWS)
    asked = max(false_alarm_every / memory, LEAST_WINDOWS)
    rise = np.maximum(1.0, np.sqrt(np.log(asked) / np.log(seen)))
    return np.asarray(np.maximum(rise[:, None] * largest, LEAST_SHARE * torque[:, None]))
