"""Options of commands whose work is shared by many workers."""

from __future__ import annotations

from typing import Annotated, Any

import typer

WORK = "Workers"


def _workers(left_out: str) -> Any:
    return typer.Option(
        "--workers",
        metavar="N",
        show_default=False,
        help=f"Processes on this machine, one thread each; {left_out} if left out.",
        rich_help_panel=WORK,
    )


Workers = Annotated[int | None, _workers("one a core")]
FewWorkers = Annotated[int | None, _workers("1")]  # of short work, which hardly repays their start
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
