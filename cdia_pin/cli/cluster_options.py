"""Options of commands whose work is shared by many workers."""

from __future__ import annotations

from typing import Annotated

import typer

from cdia_pin.cli.ranges import WORKERS

WORK = "Workers"


Workers = Annotated[
    int | None,
    typer.Option(
        "--workers",
        metavar="N",
        show_default=False,
        help="Processes on this machine, one thread each; one a core if left out.",
        callback=WORKERS,
        rich_help_panel=WORK,
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        show_default=False,
        help="Running scheduler of Dask whose workers do the work, such as tcp://10.0.0.7:8786.",
        rich_help_panel=WORK,
    ),
]
