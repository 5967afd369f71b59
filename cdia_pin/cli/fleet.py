"""``cdia fleet``: a store of what every log of every robot says about its model."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from cdia_pin.cli.cluster_options import Scheduler, Workers
from cdia_pin.cli.console import progress, stdout, warn
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.next_command import command_line, free, show_next
from cdia_pin.cli.options import Json
from cdia_pin.cli.outputs import require_writable, write_json
from cdia_pin.phrases import counted

MOST_FAILURES = 5  # that are printed; `show` has all


class Action(StrEnum):
    """What is done with a store."""

    ADD = "add"
    SHOW = "show"


def fleet(
    action: Annotated[
        Action,
        typer.Argument(
            metavar="add|show", show_default=False, help="Add logs to a store, or show what it holds."
        ),
    ],
    paths: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="LOG",
            show_default=False,
            help="Logs to add, all that the map finds if left out; of show, the folder of the store.",
        ),
    ] = None,
    *,
    robots: Annotated[
        Path | None,
        typer.Option(
            "--robots",
            metavar="MAP.toml",
            show_default=False,
            help="Which robot has which model, and which logs are its own.",
        ),
    ] = None,
    store: Annotated[
        Path | None,
        typer.Option(
            "--store", metavar="DIR", show_default=False, help="Folder of the store; made if it is not there."
        ),
    ] = None,
    retry: Annotated[bool, typer.Option("--retry", help="Try logs again that failed before.")] = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    json: Json = None,
) -> None:
    """Keep what every log of every robot says about its model, in a store that any tool for Parquet reads.

    Each log is checked, compared with the model of its robot, and fitted. A log that was added before changes nothing,
    an interrupted run goes on, and a log that fails is kept with its reason.
    """
    require_writable(json)
    given = paths or []
    if action is Action.SHOW:
        _show(given, store, json)
        return
    if robots is None or store is None:
        raise CommandError("cdia fleet add needs the map and the store: --robots MAP.toml --store DIR")
    console = stdout(json)
    with progress() as tell:
        from cdia_pin.fleet import FleetMap, FleetStore, add_logs

        fleet_map = FleetMap.read(robots)
        if not given and not fleet_map.logs:
            raise CommandError(f"the patterns of {robots} find no log")
        done = add_logs(
            FleetStore.at(store, make=True),
            fleet_map,
            given,
            retry=retry,
            workers=workers,
            scheduler=scheduler,
            progress=tell,
        )
    were = "was" if len(done.known) == 1 else "were"
    console.print(
        f"{counted(len(done.added), 'log')} added, {len(done.known)} {were} there already, {len(done.failed)} failed",
        markup=False,
    )
    for name, why in list(done.failed.items())[:MOST_FAILURES]:
        warn(f"{name}: {why}")
    if len(done.failed) > MOST_FAILURES:
        warn(f"{len(done.failed) - MOST_FAILURES} more failed; cdia fleet show {store} lists them")
    if json:
        write_json(done.to_dict(), json)
    show_next(console, command_line("trend", store, "--report", free("trend.html")))


def _show(given: list[Path], store: Path | None, json: str | None) -> None:
    folders = [*given, *([store] if store else [])]
    if len(folders) != 1:
        raise CommandError("cdia fleet show needs one store: cdia fleet show DIR")
    from cdia_pin.fleet import FleetStore
    from cdia_pin.fleet.status import fleet_status
    from cdia_pin.viewers.text_trend import status_table

    console = stdout(json)
    status = fleet_status(FleetStore.at(folders[0]))
    console.print(status_table(status))
    if json:
        write_json(status.to_dict(), json)
    show_next(console, command_line("trend", folders[0], "--report", free("trend.html")))
