"""``cdia identify``: the inertial parameters of all links, friction and rotors, from logs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.export import Export
from cdia_pin.cli.inputs import Reading, load_inputs, read_logs, require_unseen, show_inputs
from cdia_pin.cli.next_command import compare_saved, show_next, ways_of
from cdia_pin.cli.options import (
    OUTPUT,
    Check,
    Columns,
    Convert,
    Cutoff,
    Episode,
    Format,
    Gains,
    Holdout,
    JointMap,
    Json,
    Logs,
    Model,
    Robot,
    Save,
    Topic,
    TorqueSide,
)
from cdia_pin.cli.outputs import require_writable, write_all, write_json
from cdia_pin.cli.unfinished import UnfinishedSearch

if TYPE_CHECKING:
    from rich.console import Console

    from cdia_pin.identification import Identification

FITTING = "Fitting"


def identify(
    ctx: typer.Context,
    logs: Logs,
    *,
    robot: Robot,
    model: Model = None,
    holdout: Holdout = None,
    save: Save = None,
    urdf: Annotated[
        Path | None,
        typer.Option(
            "--urdf",
            "-u",
            metavar="FILE",
            show_default=False,
            help="Write a corrected URDF: link inertias, joint damping and friction.",
        ),
    ] = None,
    refine: Annotated[
        bool,
        typer.Option(
            "--refine/--plain",
            help="Use richer friction laws than Coulomb and viscous friction where the log supports them.",
            rich_help_panel=FITTING,
        ),
    ] = True,
    everything: Annotated[
        bool, typer.Option("--all", help="Show every base parameter.", rich_help_panel=OUTPUT)
    ] = False,
    cutoff: Cutoff = None,
    gains: Gains = None,
    joint_map: JointMap = None,
    convert: Convert = None,
    topic: Topic = None,
    format: Format = None,
    columns: Columns = None,
    episode: Episode = None,
    torque_side: TorqueSide = None,
    check: Check = True,
    json: Json = None,
) -> None:
    """Identify the inertial parameters of all links, friction and rotors together.

    Links stay physically consistent; parameters that the motion does not identify keep the values of the URDF.
    """
    unseen = holdout or []
    require_writable(save, urdf, json, inputs=[*logs, *unseen])
    require_unseen(unseen, logs)
    console = stdout(json)
    known = load_inputs(robot, model)
    require_writable(urdf, inputs=[known.robot.urdf])
    with progress() as tell:
        from cdia_pin import identification
        from cdia_pin.logs.conditioning import Conditioning

        settings = identification.IdentificationSettings(
            conditioning=Conditioning(cutoff=cutoff), refine=refine
        )
        reading = Reading(
            gains,
            joint_map,
            convert,
            topic,
            format,
            columns,
            episode,
            torque_side=torque_side,
            ways=ways_of(ctx),
        )
        given, _ = read_logs(logs, known.robot, reading, check=check, tell=tell, like=known)
        held_out, _ = read_logs(unseen, known.robot, reading, check=check, tell=tell, like=known)
        unfinished = UnfinishedSearch.beside(
            save, ctx.obj or "", [model, known.robot.urdf, gains], [*given, *held_out]
        )
        with unfinished.resumed(known.robot) as resumed:
            found = identification.identify(
                known,
                given,
                holdout=held_out or None,
                settings=settings,
                progress=tell,
                **resumed,
            )
    from cdia_pin.dynamics import save_model
    from cdia_pin.viewers import identification_table

    show_inputs(console, known, given, held_out)
    console.print(identification_table(found, everything=everything))
    write_all(
        console,
        (save, lambda file: save_model(found.model, file, record=found.record)),
        (urdf, lambda file: _write_urdf(found, console, file)),
        (json, lambda file: write_json(found.to_dict(), file)),
    )
    unfinished.forget()
    show_next(console, compare_saved(ctx, logs, save))


def _write_urdf(found: Identification, console: Console, file: str) -> None:
    one = Export.of("urdf", Path(file), found.model)
    one.show(console, found.model)
    one.write(file)
