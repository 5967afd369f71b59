"""A confusion: another explanation that the logs hardly distinguish from the one that was found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypedDict

from cdia_pin.effects import Effect
from cdia_pin.robot.model import RobotModel


class ConfusionJson(TypedDict):
    """A confusion in JSON; ``effect`` names the effects, joined by ``+``."""

    effect: str
    joints: list[str]
    motion: str


@dataclass(frozen=True)
class Confusion:
    """Another explanation that these logs hardly distinguish from the one that was found.

    Attributes:
        effects: The other effect, or effects.
        motion: The motion in which the two explanations differ.
    """

    effects: tuple[Effect, ...]
    motion: str

    def to_dict(self, robot: RobotModel) -> ConfusionJson:
        """Return the confusion for JSON.

        Args:
            robot: The arm, for the joints of an effect of the whole arm.
        """
        return {
            "effect": " + ".join(e.label if len(self.effects) > 1 else e.name for e in self.effects),
            "joints": list(dict.fromkeys(j for e in self.effects for j in e.joints(robot))),
            "motion": self.motion,
        }
