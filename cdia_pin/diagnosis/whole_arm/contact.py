"""Contact: several joints leave their course at the same moment, faster than the healthy arm ever does.

The remainder's slow part is followed and subtracted, so that neither a model's error nor what dry friction holds at
rest counts. What is left is compared with the largest value of healthy runs, at rest and in motion apart. A joint that
has just started or stopped may be off by its friction besides. Where a fault or a load is believed, a share of its
torque may be missed besides. At rest, friction also takes up what the load changes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis import kernels
from cdia_pin.diagnosis.kernel_cache import first_call
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.whole_arm import contact_kernel
from cdia_pin.diagnosis.whole_arm import contact_rows as rows
from cdia_pin.diagnosis.whole_arm.contact_kernel import RECOVERY

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ContactLimits:
    """Largest deviations of a healthy arm, with a margin.

    Attributes:
        rest: Of each joint at rest [N·m or N], shape (n,).
        moving: Of each joint in motion [N·m or N], shape (n,).
        friction: Torque that friction may hold at rest, and lose at a start [N·m or N], shape (n,).
    """

    rest: Array
    moving: Array
    friction: Array


class ContactDetector(Stateful):
    """Deviations of all joints from their course, and whether they mean contact.

    Args:
        limits: Largest deviations of a healthy arm.
    """

    STATE = ("_state", "_scalars")

    def __init__(self, limits: ContactLimits) -> None:
        self._limits = np.array([limits.rest, limits.moving, limits.friction])
        self._state, self._scalars = np.zeros((rows.STATE_ROWS, len(limits.rest))), np.zeros(rows.SCALARS)
        if not contact_kernel.follow.signatures:
            first_call("the detector of contact", (contact_kernel, kernels), self._tried_once)
        self.reset()

    def _tried_once(self) -> None:
        """Take a sample in the types of a control loop."""
        none = np.zeros(len(self.limit))
        self.add(0.0, 0.0, none, none, none, none)

    def reset(self) -> None:
        """Return to the start: the next sample is the slow part."""
        self._state[:], self._scalars[:] = 0.0, 0.0
        self._state[rows.LIMIT] = self._limits[rows.MOVING]
        self._state[rows.BEGUN] = np.inf
        self._scalars[[rows.RECOVERED, rows.ENDED]] = -np.inf

    @property
    def deviation(self) -> Array:
        """The remainder less its slow part [N·m or N], shape (n,)."""
        return np.asarray(self._state[rows.DEVIATION])

    @property
    def limit(self) -> Array:
        """Its limit now [N·m or N], shape (n,)."""
        return np.asarray(self._state[rows.LIMIT])

    @property
    def present(self) -> bool:
        """Whether there is contact."""
        return bool(self._scalars.item(rows.PRESENT))

    def recovers(self, t: float) -> bool:
        """Tell whether joints may still be on their way back from a contact.

        Args:
            t: Time [s].
        """
        return t < float(self._scalars.item(rows.ENDED)) + RECOVERY

    def settle(self, t: float, remainder: Array) -> None:
        """Take the present remainder as the slow part, because something has been found that explains it.

        Args:
            t: Time [s].
            remainder: [N·m or N], shape (n,).
        """
        self._state[rows.SLOW], self._state[rows.PEAK], self._state[rows.BEGUN] = remainder, 0.0, np.inf
        s = self._scalars
        s[rows.RECOVERED], s[rows.PRESENT], s[rows.LASTED] = t + RECOVERY, 0.0, 0.0
        s[rows.FOLLOWS] = 1.0

    def shift(self, change: Array) -> None:
        """Take a change of the remainder into the slow part, because what is believed has other numbers now.

        Args:
            change: [N·m or N], shape (n,).
        """
        self._state[rows.SLOW] += change

    def add(self, t: float, dt: float, remainder: Array, moving: Array, load: Array, believed: Array) -> None:
        """Add a sample.

        Args:
            t: Time [s].
            dt: Time since the last one [s].
            remainder: Residual less the torque of what is believed [N·m or N], shape (n,).
            moving: Share of the filter's memory in which each joint moved [1], shape (n,).
            load: What gravity and motion take of each joint by the model [N·m or N], shape (n,).
            believed: Largest torque of what is believed of each joint of late [N·m or N], shape (n,).
        """
        contact_kernel.follow(
            self._limits, self._state, self._scalars, remainder, moving, load, believed, t, dt
        )
