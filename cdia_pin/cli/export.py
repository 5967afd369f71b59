"""``cdia export``: a model for simulators and controllers."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdia_pin import schemas
from cdia_pin.cli.console import stdout, warn
from cdia_pin.cli.export_lines import NO_MOTION, TORQUES, show_contents, show_least_bodies, show_ranges
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.inputs import load_inputs
from cdia_pin.cli.next_command import command_line, show_next
from cdia_pin.cli.options import Json, Robot
from cdia_pin.cli.outputs import require_writable, write_all, write_document, write_json

if TYPE_CHECKING:
    from rich.console import Console

    from cdia_pin.dynamics import Dynamics
    from cdia_pin.dynamics.simulator_values import SimulatorValues
    from cdia_pin.exports import TextFormat

SIMULATORS = "Simulators"
OTHERS = "Controllers and learning"


def _file(flag: str, said: str, panel: str) -> typer.models.OptionInfo:
    option: typer.models.OptionInfo = typer.Option(
        *flag.split(), metavar="FILE", show_default=False, help=said, rich_help_panel=panel
    )
    return option


def export(
    robot: Robot,
    model: Annotated[
        Path,
        typer.Option("--model", "-m", metavar="FILE", show_default=False, help="Model to write (.json)."),
    ],
    urdf: Annotated[
        Path | None,
        _file("--urdf -u", "Corrected URDF: inertias, payload, damping, dry friction.", SIMULATORS),
    ] = None,
    mjcf: Annotated[
        Path | None,
        _file("--mjcf", "MuJoCo's format: the same, rotor inertia, springs and gravity.", SIMULATORS),
    ] = None,
    drake: Annotated[
        Path | None, _file("--drake", "Joint and actuator settings for Drake (.py).", SIMULATORS)
    ] = None,
    isaac_lab: Annotated[
        Path | None, _file("--isaac-lab", "Actuator settings for Isaac Lab (.py).", SIMULATORS)
    ] = None,
    ur_payload: Annotated[
        Path | None, _file("--ur-payload", "Payload for the controller of a UR (.script).", OTHERS)
    ] = None,
    ranges: Annotated[
        Path | None,
        _file("--ranges", "95 % intervals of all parameters, to randomise a simulation (.json).", OTHERS),
    ] = None,
    json: Json = None,
) -> None:
    """Write a model for simulators and controllers, in one format or several.

    It says which terms of the model each file holds, which it holds nearly, and which it lacks, with their torque.
    """
    asked = {"urdf": urdf, "mjcf": mjcf, "drake": drake, "isaac_lab": isaac_lab, "ur_payload": ur_payload}
    files = {key: file for key, file in asked.items() if file is not None}
    if not files and ranges is None:
        options = ", ".join("--" + key.replace("_", "-") for key in (*asked, "ranges"))
        raise CommandError(f"name a file to write, with one or more of {options}")
    console = stdout(json)
    known = load_inputs(robot, model)
    require_writable(*files.values(), ranges, json, inputs=[model, known.robot.urdf])
    if not known.terms:
        raise CommandError(f"{model} has no terms: every file would be as the URDF is")
    from cdia_pin.regression.least_bodies import with_least_bodies

    in_files, replaced = with_least_bodies(known) if files else (known, ())
    made = {}
    for key, file in files.items():
        try:
            made[key] = Export.of(key, file, in_files)
        except NothingHeldError as nothing:
            if len(files) == 1 and ranges is None:
                raise
            warn(f"{nothing}; {file} is not written")
    document: dict[str, dict[str, object]] = {}
    for key, one in made.items():
        document[key] = {"file": str(one.file), **one.show(console, in_files)}
        console.print()
    held = {label for one in made.values() for label in one.values.held}
    show_least_bodies(console, [t for t in replaced if t.label in held], in_files)
    if ranges is not None:
        document["ranges"] = {"file": str(ranges), **show_ranges(console, known)}
        console.print()
    if any(one.values.beyond for one in made.values()):
        console.print(f"{TORQUES if known.learned_from else NO_MOTION}\n")
    result = {"schema": schemas.EXPORT, "robot": known.robot.name, "files": document}
    write_all(
        console,
        *((one.file, one.write) for one in made.values()),
        (ranges, lambda f: _write_ranges(known, f)),
        (json, lambda f: write_json(result, f)),
    )
    show_next(console, command_line("compare", "LOG", "--robot", robot, "--model", model))


def _write_ranges(known: Dynamics, file: str) -> None:
    from cdia_pin.exports import ranges_document

    write_json(dict(ranges_document(known)), file)


class NothingHeldError(CommandError):
    """A format can hold no term of a model."""


@dataclass(frozen=True)
class Export:
    """A file of an export.

    Attributes:
        file: The file.
        form: Its format.
        values: What it holds of the model.
        text: Its text.
    """

    file: Path
    form: TextFormat
    values: SimulatorValues
    text: str

    @classmethod
    def of(cls, key: str, file: Path, known: Dynamics) -> Export:
        """Make the text, so that what is not possible is said before any file is written.

        Args:
            key: Name of the format.
            file: The file.
            known: The model.

        Raises:
            NothingHeldError: If the format can hold no term of the model.
        """
        from cdia_pin.exports import FORMATS

        form = FORMATS[key]
        values = form.values(known)
        if not values.held:
            raise NothingHeldError(
                f"{form.holds.noun} can hold no term of the model: {', '.join(values.left_out)}"
            )
        return cls(file, form, values, form.text(known, values, file.parent))

    def show(self, console: Console, known: Dynamics) -> dict[str, object]:
        """Print what the file holds and what it lacks, and return the same for JSON.

        Args:
            console: Where.
            known: The model.
        """
        said = show_contents(console, self.form.title, self.values, known)
        for note in self.form.notes(known, self.values):
            console.print(note, markup=False)
        return said

    def write(self, file: str) -> None:
        """Write the file."""
        write_document(self.text, file)
