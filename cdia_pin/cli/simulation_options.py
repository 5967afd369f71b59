"""Options of a simulated arm, shared by ``simulate`` and ``view``."""

from __future__ import annotations

from typing import Annotated

import typer

from cdia_pin.cli.ranges import DURATION, SEED

SIMULATION = "Simulation"

Fault = Annotated[
    list[str] | None,
    typer.Option(
        "--fault",
        metavar="FAULT",
        show_default=False,
        help="Effect of the arm that its URDF lacks, 'EFFECT@JOINT: NAME=VALUE, …'; may be repeated.",
        rich_help_panel=SIMULATION,
    ),
]
Duration = Annotated[
    float,
    typer.Option(
        "--duration", metavar="S", help="Length \\[s].", rich_help_panel=SIMULATION, callback=DURATION
    ),
]
Seed = Annotated[
    int,
    typer.Option(
        "--seed",
        metavar="N",
        help="Of the motion and the noise.",
        rich_help_panel=SIMULATION,
        callback=SEED,
    ),
]
