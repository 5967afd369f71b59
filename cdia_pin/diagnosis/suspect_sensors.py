"""Which sensors are at fault now: those that are accused, and encoders that are off by a known shift."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis import sample_codes as codes
from cdia_pin.diagnosis.sample_words import SIGNALS
from cdia_pin.diagnosis.sensor_fault import SensorCondition, SensorFault, SensorSignal
from cdia_pin.diagnosis.stateful import Stateful

Array = NDArray[np.float64]
Accusation = tuple[
    str | None, int, int
]  # joint, or None for the clock; signal; code of what is wrong with it

CONDITIONS = {
    codes.OUTSIDE: SensorCondition.OUTSIDE,
    codes.JUMP: SensorCondition.ERRATIC,
    codes.ZEROED: SensorCondition.ERRATIC,
    codes.FROZEN: SensorCondition.FROZEN,
    codes.kind_of(codes.DISAGREE): SensorCondition.BIASED,
}


class SuspectSensors(Stateful):
    """Keeps the faults of sensors.

    Args:
        joints: Names of the joints.
        least_shift: Shift of an encoder below which it is none [rad or m], shape (n,).

    Attributes:
        offset: Shift of each encoder, to be subtracted from its readings [rad or m], shape (n,); None without any.
        faults: Faults of sensors now known.
    """

    STATE = ("offset", "faults", "_shifts", "_accused")

    def __init__(self, joints: tuple[str, ...], least_shift: Array) -> None:
        self._joints, self._least = joints, least_shift
        self.reset()

    def reset(self) -> None:
        """Trust all sensors."""
        self.offset: Array | None = None
        self.faults: tuple[SensorFault, ...] = ()
        self._shifts, self._accused = np.zeros(len(self._joints)), dict[tuple[str | None, int], SensorFault]()

    def accuse(self, accused: Iterable[Accusation], since: float, is_first_only: bool) -> list[SensorFault]:
        """Call sensors faulty; return the faults that are new.

        Args:
            accused: What is accused.
            since: Time from which on they have been wrong [s].
            is_first_only: Whether one signal of a joint is accused and no other. Position and velocity accuse each
                other, and the first evidence is the better one.
        """
        new, named = [], {joint for joint, _ in self._accused}
        for joint, signal, why in accused:
            known = joint in named if is_first_only else (joint, signal) in self._accused
            if not known:
                fault = SensorFault(joint, SIGNALS[signal], CONDITIONS[codes.kind_of(why)], since)
                self._accused[joint, signal] = fault
                new.append(fault)
        if new:
            self._list(since)
        return new

    def trust(self, since: float) -> tuple[str, ...]:
        """Trust accused sensors again; return their names.

        Args:
            since: Time of the disturbance that has ended [s].
        """
        good = tuple(f.name for f in self._accused.values())
        if good:
            self._accused.clear()
            self._list(since)
        return good

    def shift(self, by: Array, since: float) -> list[tuple[str, str]]:
        """Note that encoders are off by more; return each such joint, and what is said of it.

        Args:
            by: Shift since samples were good last [rad or m], shape (n,); 0 where there is none.
            since: Time from which on they have been wrong [s].
        """
        self._shifts += by
        self._shifts[np.abs(self._shifts) <= self._least] = 0.0
        self.offset = self._shifts.copy() if self._shifts.any() else None
        self._list(since)
        off = {f.joint: str(f) for f in self.faults if f.offset}
        joints = [self._joints[j] for j in np.flatnonzero(by)]
        return [(j, off.get(j, f"encoder of {j}: reads as before its jump")) for j in joints]

    def _list(self, since: float) -> None:
        """List the faults; that of a shift that has not changed stays as old as it is."""
        known = {(f.joint, f.offset): f for f in self.faults if f.condition is SensorCondition.SHIFTED}
        shifted = []
        for joint, shift in zip(self._joints, self._shifts.tolist(), strict=True):
            if shift:
                now = SensorFault(joint, SensorSignal.POSITION, SensorCondition.SHIFTED, since, shift)
                shifted.append(known.get((joint, shift), now))
        self.faults = (*shifted, *self._accused.values())
