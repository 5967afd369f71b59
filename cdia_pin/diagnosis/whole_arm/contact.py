"""Contact: several joints leave their course at the same moment, faster than the healthy arm ever does.

The remainder's slow part is followed and subtracted, so that neither a model's error nor what dry friction holds at
rest counts. What is left is compared with the largest value of healthy runs, at rest and in motion apart. A joint that
has just started or stopped may be off by its friction besides. At rest, friction also takes up what the load changes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.stateful import Stateful

Array = NDArray[np.float64]

SLOW = 2.0  # [s], time constant of the part that is followed: a push rises and falls within it
RESTING = 0.05  # [1], share of the filter's memory in motion, below which a joint rests
CHANGING = 0.02  # [1], the same share: between it and one less it, a joint starts or stops
FIRST = 1.0  # [1], deviation over its limit that the joint with the largest one must have
SECOND = 0.7  # [1], the same of the next joint: a push reaches two at least, if not alike
TOGETHER = 0.4  # [s], within which both must have begun: a push reaches all joints at once
BEGUN = 0.35  # [1], deviation over its limit, from which it has begun
OVER = 0.5  # [1], deviation over its limit, below which all joints must be for a contact to be gone
RELEASED = 0.15  # [1], deviation over the largest one of the contact, below which a joint counts as back
HELD = 0.35  # [1], the same, where friction may hold what is left
RECOVERY = 1.0  # [s] after a contact, in which joints come back one after another, as friction lets them go
QUICK = 0.2  # [s], time constant of the part that is followed in that time
DEBOUNCE = 0.02  # [s] for which a contact must be there, or gone, before it counts


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

    Attributes:
        deviation: The remainder less its slow part [N·m or N], shape (n,).
        limit: Its limit now [N·m or N], shape (n,).
        present: Whether there is contact.
    """

    STATE = (
        "deviation",
        "limit",
        "present",
        "_slow",
        "_slow_load",
        "_changing",
        "_begun",
        "_for",
        "_recovered",
        "_ended",
        "_peak",
    )

    def __init__(self, limits: ContactLimits) -> None:
        self.limits = limits
        self.reset()

    def reset(self) -> None:
        """Return to the start: the next sample is the slow part."""
        n = len(self.limits.rest)
        self.deviation, self.limit = np.zeros(n), self.limits.moving.copy()
        self.present = False
        self._slow: Array | None = None
        self._slow_load = np.zeros(n)
        self._changing = np.zeros(
            n
        )  # have joints started or stopped of late? 1 at that moment, then falling [1]
        self._begun = np.full(n, np.inf)
        self._for, self._recovered, self._ended = 0.0, -np.inf, -np.inf
        self._peak = np.zeros(n)

    def recovers(self, t: float) -> bool:
        """Tell whether joints may still be on their way back from a contact.

        Args:
            t: Time [s].
        """
        return t < self._ended + RECOVERY

    def settle(self, t: float, remainder: Array) -> None:
        """Take the present remainder as the slow part, because something has been found that explains it.

        Args:
            t: Time [s].
            remainder: [N·m or N], shape (n,).
        """
        self._recovered = t + RECOVERY
        self._slow = remainder.copy()
        self.present, self._for = False, 0.0
        self._peak = np.zeros_like(remainder)
        self._begun[:] = np.inf

    def add(self, t: float, dt: float, remainder: Array, moving: Array, load: Array) -> None:
        """Add a sample.

        Args:
            t: Time [s].
            dt: Time since the last one [s].
            remainder: Residual less the torque of what is believed [N·m or N], shape (n,).
            moving: Share of the filter's memory in which each joint moved [1], shape (n,).
            load: What gravity and motion take of each joint by the model [N·m or N], shape (n,).
        """
        if self._slow is None:
            self._slow, self._slow_load = remainder.copy(), load.copy()
        self.deviation = remainder - self._slow
        changes = (moving > CHANGING) & (moving < 1.0 - CHANGING)
        self._changing = np.where(changes, 1.0, self._changing * np.exp(-dt / SLOW))
        self._slow_load += (1.0 - np.exp(-dt / SLOW)) * (load - self._slow_load)
        held = np.minimum(np.abs(load - self._slow_load), self.limits.friction)
        self.limit = np.where(moving < RESTING, self.limits.rest + held, self.limits.moving)
        self.limit = self.limit + self._changing * self.limits.friction
        ratio = np.abs(self.deviation) / self.limit
        self._begun = np.where(ratio < BEGUN, np.inf, np.minimum(self._begun, t))
        if self.present:
            size = np.abs(self.deviation)
            self._peak = np.maximum(self._peak, size)
            held = np.minimum(HELD * self._peak, self.limit + self.limits.friction)
            held = np.maximum(held, RELEASED * self._peak)
            self._count(dt, bool((size < np.maximum(OVER * self.limit, held)).all()))
            if not self.present:
                self._ended, self._recovered = t, t + RECOVERY
        else:
            returns = (ratio < 1.0) & (t < self._recovered)
            self._slow += (1.0 - np.exp(-dt / np.where(returns, QUICK, SLOW))) * self.deviation
            self._begun[returns] = np.inf
            self._count(dt, self._is_sudden(ratio))

    def _is_sudden(self, ratio: Array) -> bool:
        """Tell whether two joints at least are off their course, and left it at the same time."""
        if len(ratio) < 2:
            return False
        second, first = np.argsort(ratio)[-2:]
        if ratio[first] < FIRST or ratio[second] < SECOND:
            return False
        return bool(abs(self._begun[first] - self._begun[second]) < TOGETHER)

    def _count(self, dt: float, changed: bool) -> None:
        self._for = self._for + dt if changed else 0.0
        if self._for < DEBOUNCE:
            return
        self.present, self._for = not self.present, 0.0
        self._peak = np.zeros_like(self._peak)
