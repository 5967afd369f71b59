"""The events of a tick, with the joints that each concerns."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.status import Event, EventStage, Verdict
from cdia_pin.effects import Term


class EventLog(Stateful):
    """The events of the last tick, and the joints that faults concern.

    Args:
        joints: Names of the joints.

    Attributes:
        news: Events of the last tick, the latest last.
        concerned: Joints on which a fault was detected and has not cleared, shape (n,).
        cleared: Joints whose fault has cleared, shape (n,).
    """

    STATE = ("news", "concerned", "cleared")

    def __init__(self, joints: tuple[str, ...]) -> None:
        self._joints = joints
        self.news: list[Event] = []
        self.concerned: NDArray[np.bool_] = np.zeros(len(joints), dtype=bool)
        self.cleared: NDArray[np.bool_] = np.zeros(len(joints), dtype=bool)

    def add(
        self,
        time: float,
        stage: EventStage,
        verdict: Verdict,
        reason: str,
        faults: tuple[Term, ...] = (),
        alternatives: tuple[tuple[Term, ...], ...] = (),
    ) -> None:
        """Add an event. It concerns the joints of its faults; without faults all joints concerned or cleared.

        Args:
            time: Time [s].
            stage: Stage of the scheme.
            verdict: Result of isolation.
            reason: A remark for the reader.
            faults: The effects with their parameters.
            alternatives: Other combinations that explain the residual equally well.
        """
        joints = self.cleared if stage is EventStage.IDLE else self.concerned
        named = {j for term in faults for j in term.effect.scope}
        names = tuple(j for i, j in enumerate(self._joints) if (j in named if named else joints[i]))
        self.news.append(Event(time, stage, names, verdict, faults, alternatives, reason))
