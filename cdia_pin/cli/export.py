"""``cdia export``: what was found, written back into a URDF."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cdia_pin import schemas
from cdia_pin.cli.console import stdout
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.inputs import load_inputs
from cdia_pin.cli.options import Json, Robot
from cdia_pin.cli.outputs import require_writable, write_all, write_json


def export(
    robot: Robot,
    model: Annotated[
        Path,
        typer.Option(
            "--model", "-m", metavar="FILE", show_default=False, help="Model with the terms to write (.json)."
        ),
    ],
    urdf: Annotated[
        Path, typer.Option("--urdf", "-u", metavar="FILE", show_default=False, help="URDF to write.")
    ],
    json: Json = None,
) -> None:
    """Write a corrected URDF: payload, link inertias, joint damping and friction.

    Says which terms of the model have no place in a URDF.
    """
    from cdia_pin.dynamics.urdf_terms import UrdfValues
    from cdia_pin.robot import write_corrected_urdf

    require_writable(urdf, json, inputs=[model])
    console = stdout(json)
    known = load_inputs(robot, model)
    if not known.terms:
        raise CommandError(f"{model} has no terms: the corrected URDF would be the one there is")
    values = UrdfValues.of(known.terms, known.robot)
    if not values.written:
        raise CommandError(f"no term of {model} has a place in a URDF: {', '.join(values.left_out)}")
    for label in values.written:
        console.print(f"in the URDF      {label}", markup=False)
    for label, why in values.left_out.items():
        console.print(f"not in the URDF  {label}: {why}", markup=False)
    if values.damping or values.friction:
        console.print("Friction in a URDF is for simulators: cdia takes it from the model, with --model.")
    document: dict[str, object] = {
        "schema": schemas.EXPORT,
        "robot": known.robot.name,
        "urdf": str(urdf),
        "written": values.written,
        "left_out": values.left_out,
    }
    write_all(
        console,
        (urdf, lambda f: write_corrected_urdf(known.robot, f, **values.arguments)),
        (json, lambda f: write_json(document, f)),
    )
