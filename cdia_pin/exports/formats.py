"""The formats that a model can be written in, by the names that options and JSON give them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from cdia_pin.dynamics import Dynamics
from cdia_pin.dynamics.simulator_values import FileFormat, SimulatorValues
from cdia_pin.dynamics.urdf_terms import URDF, urdf_changes
from cdia_pin.errors import ModelError
from cdia_pin.exports.drake import DRAKE, drake_text
from cdia_pin.exports.isaac_lab import ISAAC_LAB, isaac_lab_text
from cdia_pin.exports.mjcf import MJCF, mjcf_notes, mjcf_text
from cdia_pin.exports.ur_payload import UR_PAYLOAD, ur_payload_text
from cdia_pin.robot.urdf_export import corrected_urdf

Values = SimulatorValues


def _no_notes(model: Dynamics, values: Values) -> Iterator[str]:
    yield from ()


@dataclass(frozen=True)
class TextFormat:
    """A text file of a model.

    Attributes:
        title: Name of the format.
        file: Name that a file of it may have.
        holds: What it can hold.
        text: Returns the text for a model, for values of it, and for the folder of the file.
        notes: Returns what else a user must know of the file.
    """

    title: str
    file: str
    holds: FileFormat
    text: Callable[[Dynamics, Values, Path], str]
    notes: Callable[[Dynamics, Values], Iterator[str]] = _no_notes

    def values(self, model: Dynamics) -> Values:
        """Return what the format can hold of a model.

        Args:
            model: The model.

        Raises:
            ModelError: If no arm can have a term that would be written.
        """
        return Values.sort(model.terms, model.robot, self.holds)


def _urdf_text(model: Dynamics, values: Values, folder: Path) -> str:
    return corrected_urdf(model.robot, folder, **urdf_changes(values))


def _urdf_notes(model: Dynamics, values: Values) -> Iterator[str]:
    if values.damping or values.friction:
        yield "Friction in a URDF is for simulators: cdia takes friction from the model, with --model."


def _drake_notes(model: Dynamics, values: Values) -> Iterator[str]:
    yield "Call its apply(plant) before plant.Finalize()."


FORMATS: dict[str, TextFormat] = {
    "urdf": TextFormat("URDF", "corrected.urdf", URDF, _urdf_text, _urdf_notes),
    "mjcf": TextFormat(
        "MJCF", "corrected.xml", MJCF, lambda model, values, _: mjcf_text(model, values), mjcf_notes
    ),
    "drake": TextFormat(
        "Drake settings",
        "drake_settings.py",
        DRAKE,
        lambda model, values, _: drake_text(model, values),
        _drake_notes,
    ),
    "isaac_lab": TextFormat(
        "Isaac Lab settings",
        "isaac_lab_settings.py",
        ISAAC_LAB,
        lambda model, values, _: isaac_lab_text(model, values),
    ),
    "ur_payload": TextFormat(
        "UR payload", "payload.script", UR_PAYLOAD, lambda model, values, _: ur_payload_text(model, values)
    ),
}


def first_format(model: Dynamics) -> str | None:
    """Return the name of the first format that can hold a term of a model; None if none can.

    Args:
        model: The model.
    """
    for name, form in FORMATS.items():
        with suppress(ModelError):
            if form.values(model).held:
                return name
    return None
