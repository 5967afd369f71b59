"""``cdia trend``: what changes on which robot over the days, beyond temperature and load."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.next_command import again, command_line, free, show_next
from cdia_pin.cli.options import OUTPUT, Json, Report
from cdia_pin.cli.outputs import require_writable, write_all, write_json
from cdia_pin.cli.ranges import FALSE_ALARMS


def trend(
    ctx: typer.Context,
    store: Annotated[
        Path, typer.Argument(metavar="DIR", show_default=False, help="Store that cdia fleet add has filled.")
    ],
    *,
    false_alarms: Annotated[
        float,
        typer.Option(
            "--false-alarms",
            metavar="RATE",
            help="False alarms that you accept for each robot \\[1/year].",
            callback=FALSE_ALARMS,
        ),
    ] = 0.1,
    regressors: Annotated[
        bool,
        typer.Option(
            "--regressors/--no-regressors",
            help="Take out what temperature and load explain, where logs have them.",
        ),
    ] = True,
    everything: Annotated[
        bool, typer.Option("--all", help="Show every change and every parameter.", rich_help_panel=OUTPUT)
    ] = False,
    report: Report = None,
    prometheus: Annotated[
        Path | None,
        typer.Option(
            "--prometheus",
            metavar="FILE",
            show_default=False,
            help="Write metrics in the text format of Prometheus.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    json: Json = None,
) -> None:
    """Show which joint of which robot wears, since when, and how sure that is.

    Each parameter has a course over the logs. Temperature and load are taken out of it, and what changes beyond them is
    an alarm. Its limit is computed from the rate of false alarms that you accept.
    """
    require_writable(report, json, tables=[prometheus])
    console = stdout(json)
    with progress() as tell:
        from cdia_pin.fleet import FleetStore, TrendSettings, fleet_trend, prometheus_text, trend_document

        found = fleet_trend(FleetStore.at(store), TrendSettings(false_alarms, regressors), tell)
    from cdia_pin.viewers.text_trend import trend_table
    from cdia_pin.viewers.trend_report import write_trend_report
    from cdia_pin.whole_files import write_whole

    console.print(trend_table(found, everything))
    write_all(
        console,
        (report, lambda f: write_trend_report(f, found, ctx.obj)),
        (prometheus, lambda f: write_whole(f, prometheus_text(found))),
        (json, lambda f: write_json(trend_document(found), f)),
    )
    nothing = not any(r.courses.logs for r in found.robots)
    add = command_line("fleet", "add", "--robots", "MAP.toml", "--store", store)
    show_next(console, add if nothing else "" if report else again(ctx, report=free("trend.html")))
