"""The terms of a model that a URDF can state, and those that it cannot."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics.simple_terms import Quantity
from cdia_pin.dynamics.simulator_values import FileFormat, SimulatorValues
from cdia_pin.effects import Term
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

URDF = FileFormat(
    "a URDF", frozenset({Quantity.BODIES, Quantity.PAYLOAD, Quantity.DAMPING, Quantity.FRICTION})
)


class UrdfChanges(TypedDict):
    """Arguments of ``write_corrected_urdf``; keys and units as the attributes of `SimulatorValues`."""

    inertial: dict[str, Array]
    damping: dict[str, float]
    friction: dict[str, float]
    payload: Array | None


class UrdfValues(SimulatorValues):
    """Values of a model's terms that a URDF can state."""

    @classmethod
    def of(cls, terms: Iterable[Term], robot: RobotModel) -> UrdfValues:
        """Sort a model's terms into those that a URDF can state and the others.

        Args:
            terms: Terms of the model.
            robot: Its robot.

        Returns:
            Values for the URDF, and the labels of all terms.

        Raises:
            ModelError: If no arm can have a term that would be written.
        """
        return cls.sort(terms, robot, URDF)

    @property
    def arguments(self) -> UrdfChanges:
        """Keyword arguments of ``write_corrected_urdf``."""
        return {
            "inertial": self.inertial,
            "damping": self.damping,
            "friction": self.friction,
            "payload": self.payload,
        }
