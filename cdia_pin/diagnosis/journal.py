"""What a monitor thought over time: which hypotheses lived, and how large it took the faults to be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cdia_pin.diagnosis.monitor import Monitor
from cdia_pin.diagnosis.status import Stage, Status
from cdia_pin.effects import Term

DECIDED_UPON = frozenset({Stage.DETECTED, Stage.ISOLATED, Stage.ACCOMMODATED})  # stages with looks
NOTED = 10.0  # [Hz], how often beliefs are noted at most


@dataclass(frozen=True)
class Look:
    """What isolation makes of a joint from a moment on, until its next look.

    Attributes:
        time: When [s].
        joint: Name of the joint.
        leading: Effects of the combination that leads; empty where nothing is looked for; None where no
            combination of the known effects is possible.
        rivals: Effects of each other combination that explains the same.
    """

    time: float
    joint: str
    leading: tuple[str, ...] | None
    rivals: tuple[tuple[str, ...], ...] = ()


@dataclass(frozen=True)
class Belief:
    """What was believed from a moment on.

    Attributes:
        time: When [s].
        faults: With their sizes and, where they are known, 95 % intervals.
    """

    time: float
    faults: tuple[Term, ...]


class Journal:
    """Keeps looks and beliefs, wherever they change.

    Args:
        monitor: Whose thoughts are kept; of an engine that takes no decisions there are no looks.
    """

    def __init__(self, monitor: Monitor) -> None:
        self.looks: list[Look] = []
        self.beliefs: list[Belief] = []
        self._joints, self._names = monitor.model.robot.joints, monitor.bank.names
        self._engine, self._seen = monitor.engine, monitor.engine.decisions
        self._live: dict[int, Look] = {}  # of the joints that are decided upon
        self._faults: tuple[Term, ...] = ()
        self._next = -np.inf

    def __call__(self, status: Status) -> None:
        """Take note of a tick."""
        seen, self._seen = self._seen, self._engine.decisions
        for j, decision in enumerate(self._seen):
            if decision is None or decision is seen[j]:
                continue
            leading = None if decision.mask is None else self._effects(decision.mask)
            rivals = tuple(self._effects(mask) for mask, _ in decision.rivals)
            self._note(j, Look(status.time, self._joints[j], leading, rivals))
        for j in [j for j in self._live if status.stages[j] not in DECIDED_UPON]:
            self._note(j, Look(status.time, self._joints[j], ()))
            del self._live[j]
        if status.faults is not self._faults and (status.events or status.time >= self._next):
            self._faults, self._next = status.faults, status.time + 1.0 / NOTED
            if status.faults or self.beliefs:
                self.beliefs.append(Belief(status.time, status.faults))

    def _note(self, j: int, look: Look) -> None:
        last = self._live.get(j)
        if last is None or (last.leading, last.rivals) != (look.leading, look.rivals):
            self._live[j] = look
            self.looks.append(look)

    def _effects(self, mask: int) -> tuple[str, ...]:
        return tuple(name for i, name in enumerate(self._names) if mask >> i & 1)
