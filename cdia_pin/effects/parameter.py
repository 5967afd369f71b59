"""Parameters: the numbers of an effect, with unit and physical range."""

from __future__ import annotations

from dataclasses import dataclass

INF = float("inf")


@dataclass(frozen=True)
class Parameter:
    """A number of an effect.

    Attributes:
        name: Name, as used in messages and files.
        unit: Unit; ``{effort}``, ``{position}`` and ``{inertia}`` become N·m, rad, kg·m² on a revolute joint
            and N, m, kg on a prismatic one.
        lower: Smallest physical value.
        upper: Largest physical value.
    """

    name: str
    unit: str
    lower: float = -INF
    upper: float = INF

    def unit_on(self, prismatic: bool) -> str:
        """Return the unit on a prismatic or on a revolute joint.

        Args:
            prismatic: Whether the joint slides.
        """
        effort, position, inertia = ("N", "m", "kg") if prismatic else ("N·m", "rad", "kg·m²")
        return self.unit.format(effort=effort, position=position, inertia=inertia)
