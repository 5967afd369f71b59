"""A confusion: another explanation that the logs hardly tell from the one that was found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cdia_pin.effects import Effect
from cdia_pin.robot.model import RobotModel


@dataclass(frozen=True)
class Confusion:
    """Another explanation that this log tells poorly from the one that was found.

    Attributes:
        effects: The other effect, or effects.
        motion: What motion would tell them apart.
    """

    effects: tuple[Effect, ...]
    motion: str

    def to_dict(self, robot: RobotModel) -> dict[str, Any]:
        """Return a JSON-ready description.

        Args:
            robot: The robot.
        """
        return {
            "effect": " + ".join(e.label if len(self.effects) > 1 else e.name for e in self.effects),
            "joints": list(dict.fromkeys(j for e in self.effects for j in e.joints(robot))),
            "motion": self.motion,
        }
