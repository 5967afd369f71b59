"""``cdia app``: find missing effects, and watch an arm, in the browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.options import Columns, Convert, Episode, Format, Gains, JointMap, Model
from cdia_pin.cli.ranges import PORT
from cdia_pin.extras import require
from cdia_pin.input_files import resolved


def app(
    log: Annotated[
        Path | None,
        typer.Argument(metavar="LOG", show_default=False, help="Log to load at once; needs --robot."),
    ] = None,
    *,
    robot: Annotated[
        str | None,
        typer.Option(
            "--robot", "-r", metavar="R", show_default=False, help="Whose log it is: a name or a URDF file."
        ),
    ] = None,
    model: Model = None,
    gains: Gains = None,
    joint_map: JointMap = None,
    convert: Convert = None,
    format: Format = None,
    columns: Columns = None,
    episode: Episode = None,
    port: Annotated[
        int | None,
        typer.Option(
            "--port",
            metavar="N",
            show_default=False,
            help="Port on 127.0.0.1; a free one if left out.",
            callback=PORT,
        ),
    ] = None,
    open_: Annotated[bool, typer.Option("--open/--no-open", help="Open a browser.")] = True,
) -> None:
    """Serve the app on this machine: load, check, compare, add missing effects, export; watch faults live.

    It needs no network, and only this machine can reach it. The page shows how the log was read, and can change it.
    """
    require("app", "the pages of cdia app")
    require("view", "the pages of cdia app")
    from cdia_pin.app.inputs import Request
    from cdia_pin.app.server import serve
    from cdia_pin.cli.inputs import load_inputs

    if (log is None) != (robot is None):
        raise CommandError("a log needs its robot, and a robot its log: cdia app LOG --robot R")
    start = None
    reading: dict[str, Any] = {
        "gains": gains,
        "joint_map": joint_map,
        "convert": convert,
        "format": format,
        "columns": columns,
        "episode": episode,
    }
    if log is not None and robot is not None:
        if not log.exists():
            raise CommandError(f"there is no log {log}")
        load_inputs(robot, model)  # what is wrong with either is said here, not in the browser
        start = Request.as_typed(robot, resolved(log), model=model and resolved(model), **reading)
    elif any(given is not None for given in (model, *reading.values())):
        raise CommandError("these options say how a log is read: cdia app LOG --robot R")
    serve(start, port=port, show=open_)
