"""``cdia convert``: any readable log as CSV, Parquet or npz in our dialect."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cdia_pin import schemas
from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.inputs import Reading, load_inputs, read_logs, show_inputs
from cdia_pin.cli.next_command import command_line, show_next
from cdia_pin.cli.options import (
    Columns,
    Convert,
    Episode,
    Format,
    Gains,
    JointMap,
    Json,
    OneLog,
    Robot,
    Topic,
)
from cdia_pin.cli.outputs import require_writable, write_all, write_json


def convert(
    ctx: typer.Context,
    log: OneLog,
    out: Annotated[
        Path, typer.Argument(metavar="OUT", show_default=False, help="File to write: .csv, .parquet or .npz.")
    ],
    *,
    robot: Robot,
    gains: Gains = None,
    joint_map: JointMap = None,
    convert: Convert = None,
    topic: Topic = None,
    format: Format = None,
    columns: Columns = None,
    episode: Episode = None,
    json: Json = None,
) -> None:
    """Write a log with the robot's joint names in SI units, as CSV, Parquet or npz.

    Gains, joint map and --convert are applied, so that the new file needs none of them.
    """
    from cdia_pin.logs import write_log
    from cdia_pin.logs.log_writer import WRITABLE

    if out.suffix.lower() not in WRITABLE:
        raise CommandError(f"cannot write {out}: the suffix must be one of {', '.join(WRITABLE)}")
    require_writable(json, inputs=[log], tables=[out])
    console = stdout(json)
    model = load_inputs(robot, None)
    with progress() as tell:
        reading = Reading(gains, joint_map, convert, topic, format, columns, episode)
        (read,), _ = read_logs([log], model.robot, reading, check=False, tell=tell)
    show_inputs(console, model, [read])
    document: dict[str, object] = {
        "schema": schemas.CONVERSION,
        "source": str(log),
        "sha256": read.sha256,
        "written": str(out),
        "robot": model.robot.name,
        "joints": list(model.robot.joints),
        "samples": len(read.time),
        "notes": list(read.notes),
    }
    write_all(console, (out, lambda f: write_log(read, f)), (json, lambda f: write_json(document, f)))
    show_next(console, command_line("check", out, "--robot", robot))
