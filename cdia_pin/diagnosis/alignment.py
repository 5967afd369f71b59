"""Alignment of signals in time: torques that act late, and velocities that are derived from positions.

Where a log or a robot has no velocities, they are the slope of a parabola through the last 2 L + 1 positions, at its
middle. The estimate is exactly L ticks old, whatever the motion. The torque waits as long, so that only the monitor as
a whole is late.
"""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.stateful import Stateful

Array = NDArray[np.float64]

HALF_WINDOW = (
    0.008  # [s], to either side, that a velocity is estimated from: less noise than usual drives' velocities
)
LEAST_HALF_WINDOW = 2  # ticks; a parabola through fewer than five positions smooths nothing
NEGLIGIBLE = 1e-9  # [ticks], part of a tick that is rounding


def half_window(dt: float) -> int:
    """Return L, the ticks to either side that a velocity is estimated from.

    Args:
        dt: Time between ticks [s].
    """
    return max(LEAST_HALF_WINDOW, round(HALF_WINDOW / dt))


def slope_of(position: Array, dt: float) -> tuple[Array, Array]:
    """Return positions and velocities of a whole run as `Alignment` derives them, shape (K − 2 L, n) each.

    Args:
        position: Positions [rad or m], shape (K, n).
        dt: Time between samples [s].
    """
    half = half_window(dt)
    windows = np.lib.stride_tricks.sliding_window_view(position, 2 * half + 1, axis=0)
    return position[half : len(position) - half], windows @ _slope_weights(half, dt)


def _slope_weights(half: int, dt: float) -> Array:
    offsets = np.arange(-half, half + 1)
    return offsets / (offsets @ offsets) / dt if half else np.zeros(0)


class Alignment(Stateful):
    """Turns raw samples into samples of one instant.

    Args:
        dt: Time between ticks [s].
        delay: Delay of a torque after its signal [s]; may be negative.
        position_only: Whether velocities are derived from positions.

    Attributes:
        lag: Ticks that a state waits.
        is_direct: Whether samples are passed on as they are.
    """

    STATE = ("_states", "_efforts")

    def __init__(self, dt: float, delay: float = 0.0, position_only: bool = False) -> None:
        self.position_only = position_only
        half = half_window(dt) if position_only else 0
        self._slope = _slope_weights(half, dt)
        late = delay / dt
        self.lag = half + max(0, int(np.ceil(-late - NEGLIGIBLE)))
        behind = self.lag + late  # ticks that a torque waits
        self._whole, self._part = int(behind), behind - int(behind)
        self._states: deque[tuple[float, Array, Array | None]] = deque(maxlen=self.lag + half + 1)
        self._efforts: deque[Array] = deque(maxlen=self._whole + 2)
        self._half = half
        self.is_direct = self.lag == 0 and self._whole == 0 and self._part < NEGLIGIBLE

    def reset(self) -> None:
        """Forget all samples."""
        self._states.clear()
        self._efforts.clear()

    def __call__(
        self, t: float, q: Array, v: Array | None, tau: Array
    ) -> tuple[float, Array, Array, Array] | None:
        """Return time, positions, velocities and torque of one instant; None until there are enough samples.

        Args:
            t: Time [s].
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,); None if they are derived.
            tau: Torque since the last tick [N·m or N], shape (n,).
        """
        if self.is_direct and v is not None:
            return t, q, v, tau
        self._states.append((t, q, v))
        self._efforts.append(tau)
        if len(self._states) < self._states.maxlen or len(self._efforts) < self._efforts.maxlen:  # type: ignore[operator]
            return None
        newest = len(self._efforts) - 1
        late = self._efforts[newest - self._whole]
        if self._part > NEGLIGIBLE:
            late = (1 - self._part) * late + self._part * self._efforts[newest - self._whole - 1]
        if not self.position_only:
            then, at, speed = self._states[0]
            assert speed is not None
            return then, at, speed, late
        window = np.array([s[1] for s in list(self._states)[: 2 * self._half + 1]])
        then = self._states[self._half][0]
        # The measured position at the middle is accurate enough; the parabola's value would gain nothing.
        return then, window[self._half], self._slope @ window, late
