"""What joints ask of the whole arm: since when, which joints, and whether some joined so late that they ask another."""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass, replace
from math import inf

ONE_AFTER_ANOTHER = (
    2.0  # [s], in which one cause shows on all joints: each needs a motion that takes its torque
)


@dataclass(frozen=True)
class Question:
    """An open question.

    Attributes:
        since: When joints began to show what is asked [s].
        joints: Indices of the joints that have shown it.
        latest: When the newest samples began to be collected: at the first alarm, or at the last late one [s].
        further: When joints first joined late, perhaps by another cause [s]; ∞ before.
    """

    since: float
    joints: frozenset[int]
    latest: float
    further: float = inf

    @classmethod
    def of(cls, joints: Set[int], t: float) -> Question:
        """Begin to ask.

        Args:
            joints: Indices of the joints that leave their thresholds.
            t: Time [s].
        """
        return cls(t, frozenset(joints), t)

    def joined_by(self, joints: Set[int], t: float) -> tuple[Question, bool]:
        """Return the question with all joints that show it, and whether some joined late.

        Args:
            joints: Indices of the joints that are beyond their thresholds now.
            t: Time [s].
        """
        if joints <= self.joints:
            return self, False
        now = replace(self, joints=self.joints | joints)
        if t - self.latest <= ONE_AFTER_ANOTHER:
            return now, False
        return replace(now, latest=t, further=min(self.further, t)), True

    def of_the_further(self) -> Question:
        """Return the question of what the joints that joined late show; the same one if none did."""
        return self if self.further == inf else replace(self, since=self.further, further=inf)
