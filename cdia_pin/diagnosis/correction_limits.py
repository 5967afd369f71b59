"""`CorrectionLimits`: what a correction may do to an arm, whatever an engine asks for."""

from __future__ import annotations

from math import inf

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.kernel_cache import first_call
from cdia_pin.diagnosis.stateful import Stateful

Array = NDArray[np.float64]

RISE_TIME = 0.02  # [s], in which a correction may rise to the effort limit: friction reverses as quickly
RAMP_TIME = 0.1  # [s], in which corrections are faded in and out, so that neither is felt as a blow
POWER_SHARE = (
    0.5  # [1], of the largest effort times the largest speed, that a correction may put into a joint
)


class CorrectionLimits(Stateful):
    """Bounds the torque that is added to a nominal one: finite, and within effort, rate and power.

    Args:
        effort: Largest effort of each joint [N·m or N], shape (n,); ``inf`` where it is not known.
        speed: Largest speed of each joint [rad/s or m/s], shape (n,).
        period: Usual time between ticks [s].
        nothing: Zero, which an engine hands over where it corrects nothing, shape (n,); any zero does, but slower.

    Attributes:
        share: Share of a correction that is let through now, from 0 to 1 [1].
        is_wanted: Whether corrections are let through at all; the share follows within `RAMP_TIME`.
        asked: The torque that an engine asked for last [N·m or N], shape (n,).
    """

    STATE = ("is_wanted", "share", "asked", "_before", "_now", "_velocity", "_elapsed", "_active")

    def __init__(self, effort: Array, speed: Array, period: float, nothing: Array | None = None) -> None:
        from cdia_pin.diagnosis import correction_kernel  # needs numba

        self._kernel = correction_kernel
        self._effort, self._period = effort, period
        self._power = POWER_SHARE * effort * speed
        self._nothing = np.zeros(len(effort)) if nothing is None else nothing
        self.is_wanted = True
        self.reset()
        if not correction_kernel.is_usual.signatures:
            first_call("the bounds of corrections", (correction_kernel,), self._tried_once)

    def _tried_once(self) -> None:
        """Bound a torque in the types of a control loop."""
        one = np.ones(len(self._effort))
        self(one)
        self.command(one, one, one)
        self._kernel.command(one, one, one, one)
        self._kernel.is_usual(one, 1.0)
        self.reset()

    def reset(self) -> None:
        """Return to the start, without any correction; whether it is wanted stays."""
        self.share = 0.0
        self._before = self._now = self.asked = self._nothing
        self._velocity, self._elapsed, self._active = self._nothing, self._period, False

    def tick(self, elapsed: float, is_trusted: bool, velocity: Array | None) -> None:
        """Begin a tick.

        Args:
            elapsed: Time since the last one [s]; the usual one if it is not above 0.
            is_trusted: Whether the sample was good.
            velocity: Velocities of the last good sample [rad/s or m/s], shape (n,); None where not known.
        """
        self._elapsed = elapsed if 0 < elapsed < inf else self._period
        self._before, self._velocity = self._now, self._nothing if velocity is None else velocity
        if is_trusted and self.is_wanted:
            if self.share < 1.0:
                self.share = min(1.0, self.share + min(self._elapsed, self._period) / RAMP_TIME)
        elif self.share > 0.0:
            self.share = max(0.0, self.share - self._elapsed / RAMP_TIME)

    def __call__(self, asked: Array) -> Array:
        """Return the torque that may be added [N·m or N], shape (n,).

        Args:
            asked: The torque that an engine wants to add [N·m or N], shape (n,).
        """
        if not self._active and (asked is self._nothing or not asked.any()):
            self.asked = self._nothing
            return self._nothing
        self.asked = asked
        rise = self._elapsed / RISE_TIME
        self._now = np.empty(len(asked))
        self._active = self._kernel.bounded(
            asked, self._before, self._velocity, self._effort, self._power, self.share, rise, self._now
        )
        return self._now

    def command(self, nominal: Array, wanted: Array, limit: Array) -> Array:
        """Return the torque to command: a nominal one, and as much of the way to a wanted one as may be added.

        Args:
            nominal: What the control law asks for [N·m or N], shape (n,).
            wanted: What an engine wants in place of it [N·m or N], shape (n,).
            limit: Effort limits [N·m or N], shape (n,); may be infinite.
        """
        self._now, out = np.empty(len(nominal)), np.empty(len(nominal))
        self._active = self._kernel.corrected_command(
            nominal, wanted, self._before, self._velocity, self._effort, self._power,
            self.share, self._elapsed / RISE_TIME, limit, self._now, out,
        )  # fmt: skip
        return out
