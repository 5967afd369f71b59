"""The course of a diagnosis over time: which hypotheses were possible, and the parameters of the believed faults."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cdia_pin.diagnosis.monitor import Monitor
from cdia_pin.diagnosis.status import Stage, Status
from cdia_pin.effects import Term

STAGES_WITH_LOOKS = frozenset({Stage.DETECTED, Stage.ISOLATED, Stage.ACCOMMODATED})
LARGEST_RATE = 10.0  # [Hz], at which beliefs are noted: enough for a figure


@dataclass(frozen=True)
class Look:
    """Result of isolation on a joint from a time on, until the next look at that joint.

    Attributes:
        time: Time from which on it holds [s].
        joint: Name of the joint.
        leading: Names of the effects of the leading combination; empty where isolation has ended; None where no
            combination of the known effects is possible.
        rivals: Names of the effects of each other combination that explains the residual equally well.
    """

    time: float
    joint: str
    leading: tuple[str, ...] | None
    rivals: tuple[tuple[str, ...], ...] = ()


@dataclass(frozen=True)
class BelievedFaults:
    """Believed faults from a time on.

    Attributes:
        time: Time from which on they are believed [s].
        faults: The faults with parameters and, where known, 95 % intervals.
    """

    time: float
    faults: tuple[Term, ...]


class Journal:
    """Keeps looks and believed faults, wherever they change.

    Args:
        monitor: The monitor; for an engine without decisions there are no looks.
    """

    def __init__(self, monitor: Monitor) -> None:
        self.looks: list[Look] = []
        self.beliefs: list[BelievedFaults] = []
        self._joints, self._names = monitor.model.robot.joints, monitor.bank.names
        self._engine, self._seen = monitor.engine, monitor.engine.decisions
        self._live: dict[int, Look] = {}  # by index of the joint, where isolation goes on
        self._faults: tuple[Term, ...] = ()
        self._next = -np.inf

    def __call__(self, status: Status) -> None:
        """Take note of a tick.

        Args:
            status: Status after the tick.
        """
        seen, self._seen = self._seen, self._engine.decisions
        for j, decision in enumerate(self._seen):
            if decision is None or decision is seen[j]:
                continue
            leading = None if decision.mask is None else self._effects(decision.mask)
            rivals = tuple(self._effects(mask) for mask, _ in decision.rivals)
            self._note(j, Look(status.time, self._joints[j], leading, rivals))
        for j in [j for j in self._live if status.stages[j] not in STAGES_WITH_LOOKS]:
            self._note(j, Look(status.time, self._joints[j], ()))
            del self._live[j]
        if status.faults is not self._faults and (status.events or status.time >= self._next):
            self._faults, self._next = status.faults, status.time + 1.0 / LARGEST_RATE
            if status.faults or self.beliefs:
                self.beliefs.append(BelievedFaults(status.time, status.faults))

    def _note(self, j: int, look: Look) -> None:
        last = self._live.get(j)
        if last is None or (last.leading, last.rivals) != (look.leading, look.rivals):
            self._live[j] = look
            self.looks.append(look)

    def _effects(self, mask: int) -> tuple[str, ...]:
        return tuple(name for i, name in enumerate(self._names) if mask >> i & 1)
