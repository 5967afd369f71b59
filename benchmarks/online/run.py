"""What a closed-loop run of the plant gives, tick by tick."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.plant.faults import Fault
from benchmarks.plant.motion import Reference

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class OnlineRun:
    """One run; arrays are (K, n), one row per tick, in the order of `joints`.

    At each tick M q̈ + nle = arrived + fault_torque, with the M and nle of the plant, which are not the model's.

    Attributes:
        joints: Names of the joints.
        time: Time of the ticks [s], shape (K,).
        q_measured: Positions as the encoders say [rad or m].
        v_measured: Velocities as measured [rad/s or m/s]; None if there are only positions.
        command: Torque that the controller asked for, held until the next tick [N·m or N].
        arrived: Torque that is with the drives, limited and late [N·m or N].
        q: True positions [rad or m].
        v: True velocities [rad/s or m/s].
        a: True accelerations just after the tick [rad/s² or m/s²].
        reference: The motion asked for.
        fault_torque: f, the torque of all faults together [N·m or N].
        faults: What was hidden.
    """

    joints: tuple[str, ...]
    time: Array
    q_measured: Array
    v_measured: Array | None
    command: Array
    arrived: Array
    q: Array
    v: Array
    a: Array
    reference: Reference
    fault_torque: Array
    faults: tuple[Fault, ...]

    @property
    def tick(self) -> float:
        """Time between two ticks [s]."""
        return float(self.time[1] - self.time[0])
