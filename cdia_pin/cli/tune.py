"""``cdia tune``: settings of a monitor for a stated rate of false alarms."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdia_pin.cli.campaign import kept_if_interrupted
from cdia_pin.cli.cluster_options import Scheduler, Workers
from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.next_command import command_line, show_next
from cdia_pin.cli.options import Json
from cdia_pin.cli.outputs import require_writable, write_all, write_json
from cdia_pin.cli.ranges import FALSE_ALARMS
from cdia_pin.whole_files import write_whole

CONFIRM = "confirm.toml"  # plan that tries the chosen settings on other arms

if TYPE_CHECKING:
    from rich.console import Console

    from cdia_pin.campaigns.tuning_result import TuningResult


def tune(
    plan: Annotated[
        Path,
        typer.Argument(
            metavar="SPEC",
            show_default=False,
            help="Plan of a campaign (.toml) with faults and healthy runs; its settings may list values of "
            "bandwidth and debounce to try.",
        ),
    ],
    *,
    false_alarms: Annotated[
        float,
        typer.Option(
            "--false-alarms",
            metavar="RATE",
            show_default=False,
            help="Largest rate of false alarms of an arm \\[1/h].",
            callback=FALSE_ALARMS,
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            metavar="DIR",
            show_default=False,
            help="Folder of the runs; out/ and the name of the plan with -tuning if left out.",
        ),
    ] = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    json: Json = None,
) -> None:
    """Choose filter, debounce and thresholds of a monitor that find faults soonest at a stated rate of false alarms.

    What was chosen holds for the arms and the faults of the plan; the next command confirms it on other ones.
    """
    from cdia_pin.campaigns.campaign_spec import plan_text, read_spec
    from cdia_pin.campaigns.tuning import tune as run

    require_writable(json)
    console = stdout(json)
    folder = out or Path("out") / f"{plan.stem}-tuning"
    spec = read_spec(plan)
    with kept_if_interrupted(folder), progress() as tell:
        found = run(spec, false_alarms, folder, workers=workers, scheduler=scheduler, progress=tell)
    _show(console, found)
    confirm = folder / CONFIRM
    write_all(
        console,
        (json, lambda f: write_json(found.to_dict(), f)),
        (confirm, lambda f: write_whole(f, plan_text(found.confirmation(spec)))),
    )
    show_next(console, command_line("campaign", confirm, "--out", f"{folder}-confirmed"))


def _show(console: Console, found: TuningResult) -> None:
    from cdia_pin.viewers.cells import table_of
    from cdia_pin.viewers.text_tuning import HEADINGS, RATE_HEADINGS, option_rows, rate_rows, tuning_answer

    for sentence in tuning_answer(found):
        console.print(sentence, markup=False)
    console.print(f"\n{found.line()}\n", markup=False, soft_wrap=True)
    console.print(table_of(HEADINGS, option_rows(found), left=()))
    console.print(table_of(RATE_HEADINGS, rate_rows(found), left=()))
