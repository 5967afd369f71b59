"""``cdia campaign``: many runs of arms with hidden faults, and what a monitor makes of them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdia_pin.cli.cluster_options import Scheduler, Workers
from cdia_pin.cli.console import progress, stdout, warn
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.next_command import command_line, show_next
from cdia_pin.cli.options import Json, Report
from cdia_pin.cli.outputs import require_report, require_writable, write_all, write_json
from cdia_pin.cli.ranges import COUNT

if TYPE_CHECKING:
    from rich.console import Console

    from cdia_pin.campaigns.campaign_result import CampaignResult
    from cdia_pin.campaigns.run_store import RunStore

Plan = Annotated[
    Path,
    typer.Argument(
        metavar="SPEC|DIR",
        show_default=False,
        help="Plan of the campaign (.toml); or the folder of one that has been run, to show it again.",
    ),
]


def campaign(
    ctx: typer.Context,
    plan: Plan,
    *,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            metavar="DIR",
            show_default=False,
            help="Folder of the runs; out/ and the name of the plan if left out.",
        ),
    ] = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    replay: Annotated[
        int | None,
        typer.Option(
            "--replay",
            metavar="N",
            show_default=False,
            help="Make one run of DIR again and show all of it.",
            callback=COUNT,
        ),
    ] = None,
    report: Report = None,
    json: Json = None,
) -> None:
    """Run many arms with hidden faults under a monitor: detections, delays, false alarms, names and tracking.

    Runs are kept as they are made, so that a campaign that was interrupted goes on with the same command.
    """
    require_report(report)
    require_writable(json, report)
    console = stdout(json)
    if plan.is_dir():
        from cdia_pin.campaigns.run_store import RunStore

        if out or workers or scheduler:
            raise CommandError(f"{plan} has been run: --out, --workers and --scheduler go with a plan")
        store = RunStore.opened(plan)
        if replay is not None:
            _replay(console, store, replay, report, json, ctx.obj or "")
            return
        _finish(console, store, report, json, ctx.obj or "")
        return
    if replay is not None:
        raise CommandError(f"--replay takes the folder of a campaign, given {plan}")
    store = _run(plan, out or Path("out") / plan.stem, workers, scheduler)
    _finish(console, store, report, json, ctx.obj or "")


def _run(plan: Path, out: Path, workers: int | None, scheduler: str | None) -> RunStore:
    from cdia_pin.campaigns.campaign import run_campaign
    from cdia_pin.campaigns.campaign_spec import read_spec
    from cdia_pin.campaigns.run_store import RunStore

    spec = read_spec(plan)
    with kept_if_interrupted(out), progress() as tell:
        run_campaign(spec, out, workers=workers, scheduler=scheduler, progress=tell)
    return RunStore.opened(out)


@contextmanager
def kept_if_interrupted(out: Path) -> Iterator[None]:
    """Say where runs are kept if the block is interrupted.

    Args:
        out: Their folder.
    """
    try:
        yield
    except KeyboardInterrupt:
        warn(f"the runs made so far are in {out}; the same command goes on from there")
        raise


def _finish(console: Console, store: RunStore, report: Path | None, json: str | None, command: str) -> None:
    """Show the result of a campaign and write it."""
    from cdia_pin.campaigns.campaign import kept_result
    from cdia_pin.viewers.campaign_report import write_campaign_report

    found = kept_result(store)
    folder = str(store.folder)
    _show(console, found, folder)
    write_all(
        console,
        (json, lambda f: write_json(found.to_dict(), f)),
        (report, lambda f: write_campaign_report(f, found, folder, command)),
    )
    console.print(f"runs in {store.folder / 'runs'}", markup=False, soft_wrap=True)
    if found.worst:
        show_next(console, command_line("campaign", folder, "--replay", found.worst[0][0].number))


def _show(console: Console, found: CampaignResult, folder: str) -> None:
    from cdia_pin.viewers.cells import table_of
    from cdia_pin.viewers.text_campaign import campaign_answer, campaign_table, names_table, worst_rows

    for sentence in campaign_answer(found):
        console.print(sentence, markup=False)
    console.print()
    console.print(campaign_table(found))
    if any(fault for fault in found.names):
        console.print(names_table(found))
    if found.worst:
        rows = [row[:3] for row in worst_rows(found, folder)]
        console.print(table_of(("run", "hidden", "worst runs"), rows, left=(1, 2)))


def _replay(
    console: Console, store: RunStore, number: int, report: Path | None, json: str | None, command: str
) -> None:
    """Make one run again, with all that the monitor recorded."""
    from cdia_pin.campaigns.campaign import found_scenario
    from cdia_pin.campaigns.watched_run import watched
    from cdia_pin.cli.monitor import show_run
    from cdia_pin.viewers import write_monitor_report

    arm, scenario = found_scenario(store.spec, number)
    with progress() as tell:
        tell("the monitor learns, then the arm moves", 0.0)
        made = watched(arm, scenario)
    hidden = "; ".join(map(str, made.faults)) or "nothing"
    console.print(f"run {number}: {arm.robot}, hidden: {hidden}", markup=False)
    if made.run is None or (run := made.run.monitored) is None:
        raise CommandError(f"run {number}: the arm ran away, so there is no whole run to show")
    show_run(console, run)
    write_all(
        console,
        (json, lambda f: write_json(run.to_dict(), f)),
        (report, lambda f: write_monitor_report(f, run, present=made.faults, command=command)),
    )
