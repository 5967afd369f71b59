"""Computed torque with a monitor that watches and corrects it, as a control program would have it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis import Monitor, Status
from cdia_pin.dynamics.controllers import ComputedTorque
from cdia_pin.dynamics.trajectories import Reference

Array = NDArray[np.float64]


class Tick(NamedTuple):
    """What a controller read, asked for and was told at one of its ticks; arrays have shape (n,).

    Attributes:
        time: Time [s].
        q: Positions as read [rad or m].
        v: Velocities as read [rad/s or m/s].
        effort: Torque that has acted since the last tick, as read [N·m or N].
        desired: Position asked for [rad or m].
        status: What the monitor said; None without one.
    """

    time: float
    q: Array
    v: Array
    effort: Array
    desired: Array
    status: Status | None


class MonitoredControl:
    """Computed torque at the rate of its ticks, watched and corrected by a monitor if there is one.

    Args:
        nominal: The control of the healthy arm.
        rate: Ticks per second; between them the torque is held [Hz].
        read: Makes a reading of position, velocity and torque, each of shape (n,).
        monitor: Is returned to its start; None for nominal control alone.
        watch: Told each tick.
    """

    def __init__(
        self,
        nominal: ComputedTorque,
        rate: float,
        read: Callable[[Array, Array, Array], tuple[Array, Array, Array]],
        monitor: Monitor | None = None,
        watch: Callable[[Tick], None] = lambda tick: None,
    ) -> None:
        self._nominal, self._period, self._read, self._monitor = nominal, 1.0 / rate, read, monitor
        self._torque = np.zeros(nominal.model.robot.n)
        self._ticks = 0
        self._watch = watch
        if monitor is not None:
            monitor.reset()

    def __call__(self, t: float, q: Array, v: Array, reference: Reference) -> Array:
        """Return the torque to command [N·m or N], shape (n,)."""
        if t < self._ticks * self._period - 1e-9:
            return self._torque
        self._ticks += 1
        q, v, tau = self._read(q, v, self._torque)
        self._torque = self._nominal(t, q, v, reference)
        status = None
        if self._monitor is not None:
            status = self._monitor.update(t, q, v, tau)
            self._torque = self._monitor.correct(self._torque, reference.v)
        self._watch(Tick(t, q, v, tau, reference.q, status))
        return self._torque
