"""``cdia monitor``: the stages of the scheme over a log, as they would have run live."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdia_pin.cli.console import progress, stdout
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.inputs import Reading, load_inputs, read_logs, show_inputs
from cdia_pin.cli.monitor_options import DEFAULT_ENGINE, MONITOR, Bank, Engine, Healthy, Threshold, thresholds
from cdia_pin.cli.next_command import again, follow, free, show_next, ways_of
from cdia_pin.cli.options import (
    Check,
    Columns,
    Convert,
    Episode,
    Format,
    Gains,
    JointMap,
    Json,
    Model,
    OneLog,
    Report,
    Robot,
    Save,
    Topic,
    TorqueSide,
)
from cdia_pin.cli.outputs import require_report, require_writable, write_all, write_json
from cdia_pin.cli.ranges import DURATION

COMPARING = "comparing the end with the healthy runs"
NO_RUNS = "the stored monitor does not keep them; cdia compare compares two logs"

if TYPE_CHECKING:
    from rich.console import Console

    from cdia_pin.diagnosis import MonitorRun


def monitor(
    ctx: typer.Context,
    log: OneLog,
    *,
    robot: Robot,
    model: Model = None,
    healthy: Healthy = None,
    healthy_until: Annotated[
        float | None,
        typer.Option(
            "--healthy-until",
            metavar="S",
            show_default=False,
            help="Length of the first part of LOG that is healthy \\[s]; 30 % of its motion, 5 to 20 s, if left out.",
            callback=DURATION,
            rich_help_panel=MONITOR,
        ),
    ] = None,
    threshold: Threshold = None,
    bank: Bank = None,
    engine: Engine = DEFAULT_ENGINE,
    velocity: Annotated[
        bool,
        typer.Option(
            "--velocity/--no-velocity",
            help="Use recorded velocities, or differentiate positions instead.",
            rich_help_panel=MONITOR,
        ),
    ] = True,
    state: Annotated[
        Path | None,
        typer.Option(
            "--state",
            metavar="FILE",
            show_default=False,
            help="Go on from where the monitor of FILE stopped, and write it there again; a new FILE is begun. "
            "It holds what the healthy runs taught.",
            rich_help_panel=MONITOR,
        ),
    ] = None,
    compare: Annotated[
        bool,
        typer.Option(
            "--compare/--no-compare",
            help="Compare the last part of LOG with the healthy runs, to name what lasts though it is small.",
            rich_help_panel=MONITOR,
        ),
    ] = True,
    save: Save = None,
    gains: Gains = None,
    joint_map: JointMap = None,
    convert: Convert = None,
    topic: Topic = None,
    format: Format = None,
    columns: Columns = None,
    episode: Episode = None,
    torque_side: TorqueSide = None,
    check: Check = True,
    report: Report = None,
    json: Json = None,
) -> None:
    """Monitor a log as if it were live: detect, isolate and accommodate faults, and note when they are cleared.

    Thresholds are learned from healthy runs; without any, from the first part of LOG. Runs of another rate are
    resampled to that of LOG. With --state, one monitor goes through several logs, a command each.
    """
    given = [log, *(healthy or [])]
    require_report(report)
    require_writable(json, report, inputs=[*given, *([model] if model else [])], tables=[state, save])
    if healthy_until is not None and (healthy or threshold):
        raise CommandError("--healthy-until concerns LOG itself: leave out --healthy and --threshold")
    goes_on = state is not None and state.exists()
    learned = {
        "--model": model,
        "--healthy": healthy,
        "--healthy-until": healthy_until,
        "--threshold": threshold,
        "--bank": bank,
        "--engine": engine != DEFAULT_ENGINE,
    }
    if goes_on and (twice := [name for name, value in learned.items() if value]):
        raise CommandError(f"{state} holds the monitor: leave out {', '.join(twice)}")
    console = stdout(json)
    known = load_inputs(robot, model)
    bounds = thresholds(threshold)
    with progress() as tell:
        from cdia_pin.diagnosis import Monitor, replay
        from cdia_pin.diagnosis.healthy_part import alike, parted

        stored = Monitor.load(state, known.robot) if state is not None and goes_on else None
        reading = Reading(
            gains,
            joint_map,
            convert,
            topic,
            format,
            columns,
            episode,
            torque_side=torque_side,
            ways=ways_of(ctx),
        )
        (watched, *runs), _ = read_logs(given, known.robot, reading, check=check, tell=tell, like=known)
        announced = []
        if stored is None and not runs and bounds is None:
            first, watched = parted(watched, healthy_until)
            runs = [first]
            announced.append(
                f"the first {first.duration:.3g} s are taken as healthy, {watched.time[0]:.6g} s on is monitored"
            )
        watched, *runs = alike([watched, *runs], velocity, announced)
        tell("learning from the healthy runs", 0.1)
        watcher = stored or Monitor(
            known,
            healthy=runs,
            threshold=bounds,
            rate=watched.rate,
            position_only=watched.velocity is None,
            bank=bank,
            engine=engine,
        )
        found = replay(
            watcher,
            watched,
            progress=lambda share: tell("monitoring" if share < 1 else COMPARING, 0.2 + 0.6 * share),
            go_on=stored is not None,
            compare_with=runs if compare else (),
        )
        if stored is not None and compare:
            found = replace(found, not_compared=NO_RUNS)
    show_inputs(console, watcher.model, [watched], notes=gains is not None)  # how they were used
    for sentence in (*announced, *found.record["notes"]):
        console.print(sentence, style="dim", markup=False)
    show_run(console, found)

    def write_report_to(file: str) -> None:
        from cdia_pin.viewers import write_monitor_report

        write_monitor_report(file, found, command=ctx.obj)

    def save_to(file: str) -> None:
        from cdia_pin.dynamics import save_model

        save_model(watcher.improved_model(), file, record=dict(found.record))

    write_all(
        console,
        (state, watcher.save),
        (save, save_to),
        (json, lambda f: write_json(found.to_dict(), f)),
        (report, write_report_to),
    )
    if state is None:  # the same command would go on with a log that the stored monitor has seen
        view = follow(ctx, "view", log, healthy=healthy) if report else ""
        show_next(console, view or again(ctx, report=free("monitor.html")))


def show_run(console: Console, found: MonitorRun) -> None:
    """Print the events of a monitor and the faults at the end.

    Args:
        console: Where.
        found: The run.
    """
    from cdia_pin.viewers import events_table, joints_table, run_summary

    if found.events:
        console.print(events_table(found))
    console.print(joints_table(found))
    console.print(run_summary(found), markup=False)
