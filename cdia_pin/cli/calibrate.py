"""``cdia calibrate``: drive gains from a payload of known mass."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.inputs import Reading, load_inputs, read_logs, show_inputs
from cdia_pin.cli.next_command import again, follow, free, show_next, ways_of
from cdia_pin.cli.options import (
    Columns,
    Convert,
    Cutoff,
    Episode,
    Format,
    Gains,
    JointMap,
    Json,
    Robot,
    Topic,
)
from cdia_pin.cli.outputs import require_writable, write_all, write_json
from cdia_pin.cli.ranges import MASS
from cdia_pin.input_files import resolved


def calibrate(
    ctx: typer.Context,
    loaded: Annotated[
        Path, typer.Argument(metavar="LOADED", show_default=False, help="Log with the payload on the tool.")
    ],
    unloaded: Annotated[
        list[Path], typer.Argument(metavar="UNLOADED", show_default=False, help="Logs without it.")
    ],
    *,
    robot: Robot,
    known_payload: Annotated[
        float,
        typer.Option(
            "--known-payload",
            metavar="KG",
            show_default=False,
            help="Mass of the payload; its centre of mass is fitted.",
            callback=MASS,
        ),
    ],
    save: Annotated[
        Path | None,
        typer.Option(
            "--save", "-s", metavar="FILE", show_default=False, help="Write the gains, as --gains reads them."
        ),
    ] = None,
    cutoff: Cutoff = None,
    gains: Gains = None,
    joint_map: JointMap = None,
    convert: Convert = None,
    topic: Topic = None,
    format: Format = None,
    columns: Columns = None,
    episode: Episode = None,
    json: Json = None,
) -> None:
    """Calibrate the scale of each joint's torque by a payload of known mass.

    Nominal drive gains are known to 10 % or so, and a payload found with them is no better. Joints that the payload
    loads get a scale of their own, all others the common one. The motions may differ, but should reach like postures.
    """
    require_writable(save, json, inputs=[loaded, *unloaded, *([gains] if gains else [])])
    if resolved(loaded) in {resolved(p) for p in unloaded}:
        raise CommandError(f"{loaded} is given with and without the payload")
    console = stdout(json)
    known = load_inputs(robot, None)
    with progress() as tell:
        from cdia_pin.identification import calibrate_gains
        from cdia_pin.logs.conditioning import Conditioning
        from cdia_pin.logs.gains import read_gains

        arm, reading = (
            known.robot,
            Reading(gains, joint_map, convert, topic, format, columns, episode, ways=ways_of(ctx)),
        )
        (with_it, *without), _ = read_logs([loaded, *unloaded], arm, reading, check=False, tell=tell)
    show_inputs(console, known, [with_it, *without], notes=gains is not None)  # how they were used
    with progress() as tell:
        tell("fitting the scales", 0.5)
        found = calibrate_gains(arm, [with_it], without, known_payload, Conditioning(cutoff=cutoff))
        nominal = read_gains(gains, arm.joints).value if gains else None
    from cdia_pin.viewers import calibration_table

    console.print(calibration_table(found, nominal))
    write_all(
        console,
        (save, lambda file: write_json(found.gains(nominal), file)),
        (json, lambda file: write_json(found.to_dict(nominal), file)),
    )
    # the scales of torques are gains only if the torques are read as currents
    applied = {"gains": save} if gains else {"gains": save, "convert": [*(convert or ()), "torque=A"]}
    calibrated = follow(ctx, "discover", *unloaded, **applied) if save else ""
    show_next(console, calibrated or again(ctx, save=free("gains.json")))
