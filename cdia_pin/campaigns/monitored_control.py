"""Computed torque with a monitor that compensates faults, as in a control program."""

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
    """Readings, desired position and status of a controller at one tick; arrays have shape (n,).

    Attributes:
        time: Time [s].
        q: Positions as read [rad or m].
        v: Velocities as read [rad/s or m/s].
        effort: Torque since the last tick, as read [N·m or N].
        desired: Desired position [rad or m].
        status: Output of the monitor; None without one.
    """

    time: float
    q: Array
    v: Array
    effort: Array
    desired: Array
    status: Status | None

    def __repr__(self) -> str:
        return f"Tick(time={self.time:.6g}, {len(self.q)} joints)"


class MonitoredControl:
    """Computed torque at the rate of its ticks, with or without a monitor that compensates faults.

    Args:
        nominal: Control law of the healthy arm.
        rate: Ticks per second [Hz]; the torque is held between them.
        read: Turns true position, velocity and torque, each of shape (n,), into readings.
        monitor: The monitor, which is reset; None for nominal control alone.
        watch: Called with each tick.
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
        """Compute the torque to command.

        Args:
            t: Time [s].
            q: True positions [rad or m], shape (n,).
            v: True velocities [rad/s or m/s], shape (n,).
            reference: The desired motion at that time.

        Returns:
            Torques [N·m or N], shape (n,); those of the last tick between two ticks.
        """
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
