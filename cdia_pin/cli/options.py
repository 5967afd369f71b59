"""Options that several commands share, each written once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cdia_pin.cli.ranges import COUNT, CUTOFF

READING = "Reading logs"
OUTPUT = "Output"

Logs = Annotated[
    list[Path],
    typer.Argument(
        metavar="LOG",
        show_default=False,
        help="Logs: .csv, .parquet, .npz, ROS 2 bags (.db3, .mcap), or folders of LeRobot datasets.",
    ),
]
LOG = typer.Argument(
    metavar="LOG",
    show_default=False,
    help="Log: .csv, .parquet, .npz, a ROS 2 bag (.db3, .mcap), or the folder of a LeRobot dataset.",
)
OneLog = Annotated[Path, LOG]
AtMostOneLog = Annotated[Path | None, LOG]
Robot = Annotated[
    str,
    typer.Option(
        "--robot",
        "-r",
        metavar="R",
        show_default=False,
        help="Name of the catalogue (see cdia robots) or path of a URDF file.",
    ),
]
Model = Annotated[
    Path | None,
    typer.Option(
        "--model",
        "-m",
        metavar="FILE",
        show_default=False,
        help="Model saved before (.json); the URDF alone if left out.",
    ),
]
Holdout = Annotated[
    list[Path] | None,
    typer.Option(
        "--holdout",
        metavar="LOG",
        show_default=False,
        help="Log that is only predicted, never fitted; may be repeated.",
    ),
]
Cutoff = Annotated[
    float | None,
    typer.Option(
        "--cutoff",
        metavar="HZ",
        show_default=False,
        help="Cut-off of the filter \\[Hz]; chosen from the log if left out.",
        callback=CUTOFF,
    ),
]
Save = Annotated[
    Path | None,
    typer.Option(
        "--save", "-s", metavar="FILE", show_default=False, help="Write the improved model (.json)."
    ),
]

Gains = Annotated[
    Path | None,
    typer.Option(
        "--gains",
        metavar="FILE",
        show_default=False,
        help="Drive gains, JSON {joint: N·m/A} or {joint: {value, tolerance}}, where the log has motor currents.",
        rich_help_panel=READING,
    ),
]
JointMap = Annotated[
    list[str] | None,
    typer.Option(
        "--joint-map",
        metavar="NAME=JOINT",
        show_default=False,
        help="Name of a joint in the log; several with commas or repeated.",
        rich_help_panel=READING,
    ),
]
Convert = Annotated[
    list[str] | None,
    typer.Option(
        "--convert",
        metavar="KEY=VALUE",
        show_default=False,
        help="Units and signs that are not SI or not the URDF's: angle=deg, torque=Nmm (or A, mA), time=ms, "
        "rate=HZ (rows without times), flip_effort=JOINT,…, gravity=compensated, reduction=JOINT:RATIO.",
        rich_help_panel=READING,
    ),
]
Topic = Annotated[
    str | None,
    typer.Option(
        "--topic",
        metavar="NAME",
        show_default=False,
        help="Topic of a bag, where several have the robot's joints.",
        rich_help_panel=READING,
    ),
]
Format = Annotated[
    str | None,
    typer.Option(
        "--format",
        metavar="NAME",
        show_default=False,
        help="Format of the logs: rtde, libfranka, ros2, lerobot or csv; recognised if left out.",
        rich_help_panel=READING,
    ),
]
Columns = Annotated[
    list[str] | None,
    typer.Option(
        "--columns",
        metavar="SIGNAL=PATTERN",
        show_default=False,
        help="Columns of other names: position=angle_#,effort=moment_#, # is the number of a joint and * its name.",
        rich_help_panel=READING,
    ),
]
Episode = Annotated[
    int | None,
    typer.Option(
        "--episode",
        metavar="N",
        show_default=False,
        help="Episode of a LeRobot dataset that has several.",
        callback=COUNT,
        rich_help_panel=READING,
    ),
]
TorqueSide = Annotated[
    str | None,
    typer.Option(
        "--torque-side",
        metavar="motor|link",
        show_default=False,
        help="Side of the gear on which the torque was measured; found from the log where it is clear.",
        rich_help_panel=READING,
    ),
]
Check = Annotated[
    bool,
    typer.Option(
        "--check/--no-check",
        help="Warn where units, signs, joint order or kind of effort look wrong.",
        rich_help_panel=READING,
    ),
]

Json = Annotated[
    str | None,
    typer.Option(
        "--json",
        metavar="FILE",
        show_default=False,
        help="Write the result as JSON; - is stdout, and silences everything else there.",
        rich_help_panel=OUTPUT,
    ),
]
Report = Annotated[
    Path | None,
    typer.Option(
        "--report",
        metavar="FILE",
        show_default=False,
        help="Write a report (.html, one file).",
        rich_help_panel=OUTPUT,
    ),
]


def examples(*commands: str) -> str:
    """Return the epilog of a command's help.

    Args:
        *commands: Lines that can be typed.
    """
    lines = "\n\n".join(f"  [cyan]{command}[/cyan]" for command in commands)
    return f"[bold]{'Example' if len(commands) == 1 else 'Examples'}[/bold]\n\n{lines}"
