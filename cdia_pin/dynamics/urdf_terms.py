"""The terms of a model that a URDF can state, and those that it cannot."""

from __future__ import annotations

from collections.abc import Iterable

from cdia_pin.dynamics.simple_terms import Quantity
from cdia_pin.dynamics.simulator_values import FileFormat, SimulatorValues
from cdia_pin.effects import Term
from cdia_pin.robot.model import RobotModel
from cdia_pin.robot.urdf_export import UrdfChanges

URDF = FileFormat(
    "a URDF", frozenset({Quantity.BODIES, Quantity.PAYLOAD, Quantity.DAMPING, Quantity.FRICTION})
)


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
        return urdf_changes(self)


def urdf_changes(values: SimulatorValues) -> UrdfChanges:
    """Return values as keyword arguments of ``write_corrected_urdf``.

    Args:
        values: What `URDF` can hold of a model.
    """
    return {
        "inertial": values.inertial,
        "damping": values.damping,
        "friction": values.friction,
        "payload": values.payload,
    }
